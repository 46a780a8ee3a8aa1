# SPDX-License-Identifier: Apache-2.0
"""From a log to a model with a verdict: what is kept, judged by what was known causally."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.metadata import version

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import (
    DriveRun,
    WindowSet,
    choose_input,
    collect_windows,
    has_wheels,
    prepare_drive,
)
from slipwise.calibration.estimator_run import run_estimator
from slipwise.calibration.forecast import Forecaster, final_tail, forecast, forecast_all, tail_of
from slipwise.calibration.judgement import FEWEST_WINDOWS, Judgement, judge
from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.learner import Belief, Progress
from slipwise.calibration.limit_words import limits_advice
from slipwise.calibration.plain import plain_forecaster
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.result import Calibration, History, Verdict
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.shortage import shortage_advice
from slipwise.calibration.smoothing import smooth as smooth_windows
from slipwise.calibration.verdict import LogFacts, give_verdict, identified
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
    """What learning gave."""

    kept: Belief
    identifiable: Belief  # the same; of the next best where the baseline is kept, which has no parameters
    predictions: tuple[Predictions, ...]  # causal, of the horizons that are judged
    baseline: tuple[Predictions, ...]  # the kinematic baseline's, of the same segments
    tails: dict[float, schema.Tail]
    history: History | None
    bases: tuple[str, ...]
    limits: _core.LimitSearch | None = None  # what a search found, whether kept or not


@dataclass(frozen=True, eq=False)
class _Judged:
    """What goes into a model file beside what was learned."""

    judgement: Judgement
    verdict: Verdict


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
    learn = _by_learner if settings.estimator == AVERAGE else _by_estimator
    learned = learn(settings, windows, progress)
    judged = _judged(learned, windows, (log, input_name, settings), found)
    content = _content(learned, judged, (log, input_name, settings), windows)
    return Calibration(
        model_of(content, log, found),
        judged.verdict,
        learned.history,
        log.left_out + windows.left_out,
        log.notes,
        smooth_windows(learned.kept, windows, settings) if smooth else None,
    )


def _by_learner(settings: Settings, windows: WindowSet, progress: Progress | None) -> _Learned:
    """Learn in one pass, which also makes the predictions that are judged."""
    keep = Keep(settings.vehicle.track)
    learned = learn_log(windows.drive, settings, JUDGING_HORIZONS, keep=keep, progress=progress)
    tails = {
        p.horizon: tail_of(student)
        for p, student in zip(learned.predictions, learned.students, strict=True)
        if len(p)
    }
    return _Learned(
        learned.kept,
        learned.slip,
        learned.predictions,
        learned.baseline,
        tails,
        learned.history,
        learned.bases,
        learned.limits,
    )


def _by_estimator(settings: Settings, windows: WindowSet, progress: Progress | None) -> _Learned:
    """Learn with one of the estimators that the learner is compared with."""
    run = run_estimator(settings, windows.drive[0].input_name, windows, record=True, progress=progress)
    forecaster = Forecaster("learned", settings.filter_settings().noise.shape, run.belief, run.dynamics)
    sets = [collect_windows(windows.drive, horizon, settings.rules()) for horizon in JUDGING_HORIZONS]
    predictions = forecast_all(forecaster, windows, sets)
    plain = tuple(forecast(plain_forecaster(settings), windows, targets) for targets in sets)
    tails = {p.horizon: final_tail(p) for p in predictions if len(p)}
    kept = run.kept()
    return _Learned(kept, kept, predictions, plain, tails, run.history(), run.bases)


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
    learned: _Learned,
    windows: WindowSet,
    given: tuple[Log, str, Settings],
    found: tuple[Contradiction, ...],
) -> _Judged:
    """Judge what is known causally on held-out windows, at the longest horizon with enough of them.

    The predictions are those that `evaluate` makes of the same method, so that one error stands in the
    verdict, the model file, the report and the scores.
    """
    log, input_name, settings = given
    counts = [len(p) for p in learned.predictions]
    enough = [k for k, count in enumerate(counts) if count >= 2 * FEWEST_WINDOWS]
    some = [k for k, count in enumerate(counts) if count]
    chosen = enough[-1] if enough else (some or [0])[0]
    judgement = judge(learned.predictions[chosen], learned.baseline[chosen])
    shortage: tuple[str, ...] = ()
    if judgement.too_short:
        shortest = collect_windows(windows.drive, JUDGING_HORIZONS[0], settings.rules())
        shortage = shortage_advice(log, input_name, shortest, settings)
    known = identified(
        learned.identifiable,
        wheels_logged=has_wheels(windows.drive),
        wheels_advice=log.advice.get("wheel", ""),
    )
    verdict = give_verdict(judgement, known, LogFacts(found, shortage, input_name))
    if learned.limits is not None and not any(each.spoils for each in found):
        verdict = replace(verdict, advice=(*verdict.advice, *limits_advice(learned.limits)))
    return _Judged(judgement, verdict)


def _content(
    learned: _Learned, judged: _Judged, given: tuple[Log, str, Settings], windows: WindowSet
) -> schema.ModelFile:
    log, input_name, settings = given
    motion, verdict = learned.kept.motion, judged.verdict
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
        limits=_limits(learned),
        parameters=_parameters(learned.kept),
        covariance=learned.kept.covariance.tolist(),
        noise=_noise(learned, settings),
        coloured=_coloured(learned.kept, windows.length),
        range=_range(windows.drive),
        weights=dict(zip(learned.bases, map(float, learned.kept.weights), strict=False)),
        provenance=schema.Provenance(
            slipwise_version=version("slipwise"),
            logs=[schema.LogReference(path=source.path, sha256=source.sha256) for source in log.sources],
            settings=settings.model_dump(exclude_defaults=True),
            learned_seconds=float(np.sum(windows.end - windows.start)),
            learned_windows=len(windows),
        ),
        verdict=schema.VerdictSection(
            good=verdict.good,
            sentence=verdict.sentence,
            undetermined=list(verdict.undetermined),
            advice=list(verdict.advice),
            look_alikes=[
                schema.LookAlike(first=pair.first, second=pair.second, correlation=pair.correlation)
                for pair in verdict.look_alikes
            ],
            timing=verdict.timing,
            reservations=list(verdict.reservations),
            contradictions=list(verdict.contradictions),
            held_out=judged.judgement.held_out,
        ),
    )


def _limits(learned: _Learned) -> schema.LimitsSection | None:
    """Limits that a search found, where they are kept."""
    return None if learned.kept.limits is None or learned.limits is None else limits_section(learned.limits)


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
        scale=learned.kept.noise_scale.tolist(),
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
