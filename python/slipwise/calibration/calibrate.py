# SPDX-License-Identifier: Apache-2.0
"""From a log to a model with a verdict: the causal pass by default, the batch fit where asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.metadata import version

import numpy as np

from slipwise import _core
from slipwise.calibration.batch import fit_batch
from slipwise.calibration.causal_pass import CausalPass, HistoryRecorder
from slipwise.calibration.drive import (
    DriveRun,
    WindowSet,
    choose_input,
    collect_windows,
    prepare_drive,
)
from slipwise.calibration.forecast import Forecaster, final_tail, forecast, forecast_all
from slipwise.calibration.learner import Belief, Learner, Progress, make_learner
from slipwise.calibration.limit_words import limits_advice
from slipwise.calibration.plain import plain_forecaster
from slipwise.calibration.result import Calibration, History, Verdict
from slipwise.calibration.settings import Settings
from slipwise.calibration.structure_choice import StructureChoice, learning_pass
from slipwise.calibration.verdict import FEWEST_WINDOWS, UNDETERMINED_RATIO, Judgement, give_verdict, judge
from slipwise.errors import LogError
from slipwise.logs.log import Log
from slipwise.models import schema
from slipwise.models.limits import limits_section
from slipwise.models.model import Model

JUDGING_HORIZONS = (1.0, 2.0, 5.0)  # s


@dataclass(frozen=True, eq=False)
class _Learned:
    """What learning gave, before it is put into a model file."""

    motion: _core.MotionModel
    belief: Belief
    tails: dict[float, schema.Tail]
    judgement: Judgement
    verdict: Verdict
    limits: schema.LimitsSection | None = None


def calibrate(
    log: Log,
    *,
    input_name: str | None = None,
    settings: Settings | None = None,
    batch: bool = False,
    progress: Progress | None = None,
) -> Calibration:
    """Learn the motion model of the robot in `log`.

    Args:
        log: what `open_log` returned.
        input_name: "command" or "wheel"; by default commands where the log has them.
        settings: what to learn and how.
        batch: fit all windows at once off-line; the verdict is still that of the causal pass.
        progress: called with the share done, 0 to 1.

    Raises:
        LogError: the log has no such input, no poses, or no window to learn from.
        SettingsError: a basis or a term is unknown.
    """
    settings = settings or Settings()
    input_name = input_name or choose_input(log)
    drive = prepare_drive(log, input_name)
    windows = learning_windows(drive, input_name, settings)
    refuse_empty(windows, log)
    learner = make_learner(settings, input_name)
    average = learner.fresh()
    names = tuple(basis.name for basis in learner.bases)
    recorder = HistoryRecorder(average.model, windows, names, progress)
    passing = (
        CausalPass(average, windows, recorder)
        if batch
        else learning_pass(average, windows, settings, recorder)
    )
    shape = settings.filter_settings().noise.shape
    forecaster = Forecaster("learned", average.model, shape, passing.belief, learner.dynamics)
    learned = _judged(forecaster, passing, windows, settings)
    history = recorder.history if isinstance(passing, CausalPass) else passing.history(recorder.history)
    if batch:
        learned = fit_batch_over(learned, learner, windows, average.reference_speeds)
    model = Model(_content(learned, (log, input_name, settings), windows, history))
    return Calibration(
        model, learned.verdict, None if batch else history, log.left_out + windows.left_out, log.notes
    )


def learning_windows(drive: tuple[DriveRun, ...], input_name: str, settings: Settings) -> WindowSet:
    """Cut the windows to learn from: of the length in the settings, or whole frames that are shorter."""
    rules = replace(settings.rules(), whole_frames=True)
    return collect_windows(drive, settings.window_length(input_name), rules)


def refuse_empty(windows: WindowSet, log: Log) -> None:
    """Raise LogError where there is no window at all, saying why."""
    if len(windows):
        return
    reasons = "; ".join(f"{item.count} x {item.reason}" for item in windows.left_out)
    still = {item.kind for item in windows.left_out} - {"late-pose"} == {"standing-still"}
    raise LogError(
        "the robot never moves in this log" if still else "the log has no window to learn from",
        where=", ".join(source.path for source in log.sources[:3]),
        advice=reasons
        or f"poses and inputs must overlap for at least {windows.length:g} s; see `slipwise inspect`",
    )


def _judged(
    forecaster: Forecaster, passing: CausalPass | StructureChoice, windows: WindowSet, settings: Settings
) -> _Learned:
    """Judge the causal pass on its own held-out windows, at the longest horizon with enough of them."""
    sets = [collect_windows(windows.drive, horizon, settings.rules()) for horizon in JUDGING_HORIZONS]
    judged = [targets for targets in sets if len(targets)]
    predictions = forecast_all(forecaster, windows, judged or [windows])
    belief = passing.finish()
    tails = {p.horizon: final_tail(p, cascade=belief.motion is not None) for p in predictions}
    enough = [k for k, p in enumerate(predictions) if len(p) >= 2 * FEWEST_WINDOWS]
    chosen = enough[-1] if enough else 0
    plain = forecast(plain_forecaster(settings), windows, (judged or [windows])[chosen])
    judgement = judge(predictions[chosen], plain)
    motion = belief.motion or forecaster.model
    names = tuple(info.name for info in motion.parameters)
    verdict = give_verdict(judgement, names, belief)
    limits = None
    if isinstance(passing, StructureChoice) and passing.limits is not None:
        verdict = replace(verdict, advice=(*verdict.advice, *limits_advice(passing.limits)))
        limits = None if belief.limited is None else limits_section(passing.limits)
    return _Learned(motion, belief, tails, judgement, verdict, limits)


def fit_batch_over(
    learned: _Learned, learner: Learner, windows: WindowSet, speeds: tuple[float, float]
) -> _Learned:
    """Replace the causal belief by the batch fit over all windows; the verdict stays the causal one's."""
    noise = learner.settings.filter_settings().noise.shape
    belief = fit_batch(learned.motion, windows, learner.settings, (noise, learned.belief.noise_scale), speeds)
    return _Learned(learned.motion, belief, learned.tails, learned.judgement, learned.verdict)


def _content(
    learned: _Learned, given: tuple[Log, str, Settings], windows: WindowSet, history: History
) -> schema.ModelFile:
    log, input_name, settings = given
    basis = learned.motion.basis
    return schema.ModelFile(
        slipwise_model=schema.SCHEMA_VERSION,
        input="command" if input_name == "command" else "wheel",
        slip=schema.Slip(basis=basis.name, lon=basis.lon, lat=basis.lat, ang=basis.ang),
        dynamics=learned.motion.dynamics,
        clock_offset=learned.motion.clock_offset,
        response=learned.motion.response,
        limits=learned.limits,
        parameters=_parameters(learned.motion, learned.belief),
        covariance=learned.belief.covariance.tolist(),
        noise=_noise(learned, settings),
        range=_range(windows.drive),
        weights=dict(zip(history.bases, map(float, learned.belief.weights), strict=False)),
        provenance=schema.Provenance(
            slipwise_version=version("slipwise"),
            logs=[schema.LogReference(path=source.path, sha256=source.sha256) for source in log.sources],
            settings=settings.model_dump(exclude_defaults=True),
            learned_seconds=float(np.sum(windows.end - windows.start)),
            learned_windows=len(windows),
        ),
        verdict=schema.VerdictSection(
            good=learned.verdict.good,
            sentence=learned.verdict.sentence,
            undetermined=list(learned.verdict.undetermined),
            advice=list(learned.verdict.advice),
            held_out=learned.judgement.held_out,
        ),
    )


def _parameters(motion: _core.MotionModel, belief: Belief) -> list[schema.Parameter]:
    stds = np.sqrt(np.diag(belief.covariance))
    return [
        schema.Parameter(
            name=info.name,
            unit=info.unit,
            value=float(belief.mean[i]),
            std=float(stds[i]),
            prior_std=float(belief.prior_std[i]),
            determined=bool(belief.variance_ratio[i] <= UNDETERMINED_RATIO),
        )
        for i, info in enumerate(motion.parameters)
    ]


def _noise(learned: _Learned, settings: Settings) -> schema.Noise:
    shape = settings.noise
    return schema.Noise(
        psd_time=shape.psd_time,
        psd_motion=shape.psd_motion,
        fraction=shape.fraction,
        pose_std_xy=shape.pose_std_xy,
        pose_std_yaw=shape.pose_std_yaw,
        scale=learned.belief.noise_scale.tolist(),
        tails=learned.tails,
    )


def _range(drive: tuple[DriveRun, ...]) -> schema.Range:
    speed = np.concatenate([run.inputs.v for run in drive])
    yaw_rate = np.concatenate([run.inputs.omega for run in drive])
    tilts = [t for run in drive for t in (run.run.poses.roll, run.run.poses.pitch) if t is not None]
    steepest = float(np.nanmax(np.abs(np.concatenate(tilts)))) if tilts else 0.0
    return schema.Range(
        speed=[float(speed.min()), float(speed.max())],
        yaw_rate=[float(yaw_rate.min()), float(yaw_rate.max())],
        slope=steepest if np.isfinite(steepest) else 0.0,
    )
