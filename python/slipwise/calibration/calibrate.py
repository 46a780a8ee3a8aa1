# SPDX-License-Identifier: Apache-2.0
"""From a log to a model with a verdict: what is kept, judged by what was known causally."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.metadata import version

import numpy as np

from slipwise.calibration.drive import (
    DriveRun,
    WindowSet,
    choose_input,
    collect_windows,
    prepare_drive,
)
from slipwise.calibration.forecast import Forecaster, final_tail, forecast, forecast_all
from slipwise.calibration.judgement import FEWEST_WINDOWS, Judgement, judge
from slipwise.calibration.learner import Belief, Progress
from slipwise.calibration.learning_run import LearningRun, start_learning
from slipwise.calibration.limit_words import limits_advice
from slipwise.calibration.plain import plain_forecaster
from slipwise.calibration.result import Calibration, Verdict
from slipwise.calibration.settings import Settings
from slipwise.calibration.shortage import shortage_advice
from slipwise.calibration.smoothing import smooth as smooth_windows
from slipwise.calibration.verdict import LogFacts, give_verdict, identified
from slipwise.calibration.wheel_drive import has_wheels
from slipwise.errors import LogError, ModelError
from slipwise.logs.contradiction import Contradiction
from slipwise.logs.contradictions import contradictions
from slipwise.logs.log import Log
from slipwise.models import schema
from slipwise.models.limits import limits_section
from slipwise.models.model import Model

JUDGING_HORIZONS = (1.0, 2.0, 5.0)  # s


@dataclass(frozen=True, eq=False)
class _Learned:
    """What learning gave, before it is put into a model file."""

    belief: Belief
    tails: dict[float, schema.Tail]
    judgement: Judgement
    verdict: Verdict
    limits: schema.LimitsSection | None = None


def calibrate(
    log: Log,
    *,
    input: str | None = None,
    settings: Settings | None = None,
    smooth: bool = False,
    progress: Progress | None = None,
) -> Calibration:
    """Learn the motion model of the robot in `log`.

    Args:
        log: what `open_log` returned.
        input: "command" or "wheel"; by default commands where the log has them.
        settings: what to learn and how. Where the estimator fits all windows at once, off-line, the verdict
            is that of the filter that runs along.
        smooth: also say what the slip was during each window, given the whole log: for slip that changes
            slowly. The model stays what it is.
        progress: called with the share done, 0 to 1.

    Raises:
        LogError: the log has no such input, no poses or no window to learn from, or no model holds it.
        SettingsError: a basis or a term is unknown.
    """
    settings = settings or Settings()
    input_name = input or choose_input(log)
    drive = prepare_drive(log, input_name)
    windows = learning_windows(drive, input_name, settings)
    refuse_empty(windows, log)
    found = contradictions(log, input_name, settings.window.unknown_after, sensor_yaw=settings.mount.yaw)
    run = start_learning(settings, input_name, windows, record=True, progress=progress)
    learned = _judged(run, windows, (log, input_name, settings), found)
    model = model_of(_content(learned, (log, input_name, settings), windows, run.bases), log, found)
    return Calibration(
        model,
        learned.verdict,
        run.history(),
        log.left_out + windows.left_out,
        log.notes,
        smooth_windows(learned.belief, windows, settings) if smooth else None,
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


def model_of(content: schema.ModelFile, log: Log, found: tuple[Contradiction, ...]) -> Model:
    """Make the model of a log, of which `found` is what contradicts itself.

    Raises:
        LogError: no model has such parameters; such a log may lead to them.
    """
    try:
        return Model(content)
    except ModelError as problem:
        raise LogError(
            f"no robot explains this log: {'; '.join(each.sentence for each in found) or problem.what}",
            where=", ".join(source.path for source in log.sources[:3]),
            advice=" ".join(text for each in found for text in each.advice)
            or "check that poses and inputs are of one drive, in m, rad, m/s and rad/s",
        ) from problem


def _judged(
    run: LearningRun,
    windows: WindowSet,
    given: tuple[Log, str, Settings],
    found: tuple[Contradiction, ...],
) -> _Learned:
    """Judge what is known causally on held-out windows, at the longest horizon with enough of them.

    The predictions are those that `evaluate` makes of the same method, so that one error stands in the
    verdict, the model file, the report and the scores.
    """
    log, input_name, settings = given
    shape = settings.filter_settings().noise.shape
    forecaster = Forecaster("learned", shape, run.belief, run.dynamics)
    sets = [collect_windows(windows.drive, horizon, settings.rules()) for horizon in JUDGING_HORIZONS]
    judged = [targets for targets in sets if len(targets)]
    predictions = forecast_all(forecaster, windows, judged or [windows])
    belief = run.kept()
    tails = {p.horizon: final_tail(p, belief.structure) for p in predictions}
    enough = [k for k, p in enumerate(predictions) if len(p) >= 2 * FEWEST_WINDOWS]
    chosen = enough[-1] if enough else 0
    plain = forecast(plain_forecaster(settings), windows, (judged or [windows])[chosen])
    judgement = judge(predictions[chosen], plain)
    shortage = shortage_advice(log, input_name, sets[0], settings) if judgement.too_short else ()
    wheels_advice = log.advice.get("wheel", "")
    known = identified(belief, wheels_logged=has_wheels(windows.drive), wheels_advice=wheels_advice)
    verdict = give_verdict(judgement, known, LogFacts(found, shortage, input_name))
    search = run.limits()
    if search is None:
        return _Learned(belief, tails, judgement, verdict)
    if not any(each.spoils for each in found):
        verdict = replace(verdict, advice=(*verdict.advice, *limits_advice(search)))
    limits = None if belief.limited is None else limits_section(search)
    return _Learned(belief, tails, judgement, verdict, limits)


def _content(
    learned: _Learned, given: tuple[Log, str, Settings], windows: WindowSet, bases: tuple[str, ...]
) -> schema.ModelFile:
    log, input_name, settings = given
    motion = learned.belief.motion
    basis = motion.basis
    return schema.ModelFile(
        slipwise_model=schema.SCHEMA_VERSION,
        input="command" if input_name == "command" else "wheel",
        slip=schema.Slip(basis=basis.name, lon=basis.lon, lat=basis.lat, ang=basis.ang),
        dynamics=motion.dynamics,
        delays=motion.delays,
        clock_offset=motion.clock_offset,
        response=motion.response,
        mount=motion.mount,
        limits=learned.limits,
        parameters=_parameters(learned.belief),
        covariance=learned.belief.covariance.tolist(),
        noise=_noise(learned, settings),
        coloured=_coloured(learned.belief, windows.length),
        start=_start(learned.belief),
        range=_range(windows.drive),
        weights=dict(zip(bases, map(float, learned.belief.weights), strict=False)),
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
            look_alikes=[
                schema.LookAlike(first=pair.first, second=pair.second, correlation=pair.correlation)
                for pair in learned.verdict.look_alikes
            ],
            timing=learned.verdict.timing,
            reservations=list(learned.verdict.reservations),
            contradictions=list(learned.verdict.contradictions),
            held_out=learned.judgement.held_out,
        ),
    )


def _parameters(belief: Belief) -> list[schema.Parameter]:
    stds = np.sqrt(np.diag(belief.covariance))
    return [
        schema.Parameter(
            name=info.name,
            unit=info.unit,
            value=float(belief.mean[i]),
            std=float(stds[i]),
            prior_std=float(belief.prior_std[i]),
            determined=bool(belief.variance_ratio[i] <= schema.UNDETERMINED_RATIO),
        )
        for i, info in enumerate(belief.motion.parameters)
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


def _coloured(belief: Belief, window: float) -> schema.Coloured | None:
    if belief.coloured is None:
        return None
    law = belief.coloured.law
    candidates = [
        schema.Wander(
            drift=wander.drift, turn=wander.turn, time_constant=wander.time_constant, weight=float(weight)
        )
        for wander, weight in zip(law.candidates, law.weights, strict=True)
    ]
    return schema.Coloured(window=window, candidates=candidates)


def _start(belief: Belief) -> schema.Start | None:
    if belief.start is None:
        return None
    law = belief.start.law
    memories = [
        schema.PoseMemory(seconds=seconds, weight=float(weight))
        for seconds, weight in zip(law.memories, law.weights, strict=True)
    ]
    return schema.Start(memories=memories)


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
