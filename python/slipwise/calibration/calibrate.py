# SPDX-License-Identifier: Apache-2.0
"""From a log to a model with a verdict: what is kept, judged by what was known causally."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from slipwise.calibration.estimator_run import estimator_info
from slipwise.calibration.gyro_clock import gyro_clock
from slipwise.calibration.inputs_seen import WheelStep
from slipwise.calibration.judge import Judged, Sensors, judge, to_judge
from slipwise.calibration.judgement import Judgement, too_short
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.learner import Progress
from slipwise.calibration.model_content import ModelFacts, model_content
from slipwise.calibration.mounts import Mount, holding_mounts, mounts_of
from slipwise.calibration.plain import baseline_predictor
from slipwise.calibration.predictors import Predictor, final_student, predict_all, predictions_of
from slipwise.calibration.prepared_run import (
    PreparedRun,
    WindowSet,
    choose_input,
    collect_windows,
    frames_apart,
    has_wheels,
    prepare_run,
    unused_runs,
    used_sources,
)
from slipwise.calibration.result import Calibration
from slipwise.calibration.same_log import learned_before
from slipwise.calibration.settings import AVERAGE, Settings
from slipwise.calibration.settings_for_log import for_positions, for_the_ground_of
from slipwise.calibration.shares import PoseSensor
from slipwise.calibration.shortage import shortage_advice, silence, unused_measurements, unused_wheels
from slipwise.calibration.smoothing import smooth as smooth_windows
from slipwise.calibration.unlike_logs import unlike_logs
from slipwise.calibration.verdict import LogFacts
from slipwise.errors import LogError, ModelError, SettingsError
from slipwise.logs.findings.checks import findings_in, findings_of_log, findings_of_others
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import Seen, WholeLog
from slipwise.logs.findings.steering import Commanded
from slipwise.logs.gyro import gyro_alone
from slipwise.logs.log import Log, has_course
from slipwise.logs.motion_windows import evidence_of
from slipwise.models import schema
from slipwise.models.axes import sideways_span
from slipwise.models.model import Model
from slipwise.segments import attitude_rows

JUDGING_HORIZONS = (1.0, 2.0, 5.0)  # s


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
        progress: called with the fraction done, 0 to 1.

    Raises:
        LogError: the log has no such input, no poses or no window to learn from, or no model holds it.
        SettingsError: a basis or a term is unknown.
    """
    settings = for_the_ground_of(log, settings or Settings())
    learn = _by_learner if settings.estimator == AVERAGE else _by_estimator
    return calibrate_by(
        lambda windows: learn(settings, windows, progress),
        log,
        choose_input(log, input),
        settings,
        smooth=smooth,
    )


def calibrate_by(
    learn: Callable[[WindowSet], Learned],
    log: Log,
    input_name: str,
    settings: Settings,
    *,
    smooth: bool = False,
) -> Calibration:
    """Learn a log by whatever learns its windows, and judge it; `settings` are those for the log's ground.

    Raises:
        LogError: the log has no such input, no poses or no window to learn from, or no model holds it.
    """
    windows = learning_windows(prepare_run(log, input_name), input_name, settings)
    refuse_empty(windows, log)
    learned = learn(windows)
    found = found_contradictions(learned, windows.drive, (log, input_name, settings))
    judged, content = judged_content(learned, windows, (log, input_name, settings), found)
    mounts = learned_mounts(learned, log, settings)
    return Calibration(
        model_of(content, log, found, mounts),
        judged.verdict,
        learned.history,
        (*log.left_out, *unused_runs(log, input_name), *windows.left_out),
        (
            *notes_of(learned, log, found, mounts),
            *unused_measurements(log, settings, smooth=smooth),
            *unused_wheels(log, settings, learned.kept, input_name),
        ),
        smooth_windows(learned.kept, windows, settings) if smooth else None,
        learned.predictions if settings.estimator == AVERAGE else (),
        learned.baseline if settings.estimator == AVERAGE else (),
        mounts,
    )


def model_of_log(
    learned: Learned, log: Log, input_name: str, settings: Settings, start: Model | None = None
) -> tuple[Model, Judgement]:
    """Return the model that `calibrate` makes of a log that a learner has learned, begun with `start`.

    Raises:
        LogError: no model holds what was learned.
    """
    windows = learning_windows(prepare_run(log, input_name), input_name, settings)
    found = found_contradictions(learned, windows.drive, (log, input_name, settings), start)
    judged, content = judged_content(learned, windows, (log, input_name, settings), found)
    return model_of(content, log, found, learned_mounts(learned, log, settings)), judged.judgement


def found_contradictions(
    learned: Learned,
    drive: tuple[PreparedRun, ...],
    given: tuple[Log, str, Settings],
    start: Model | None = None,
) -> tuple[Finding, ...]:
    """Return where poses and inputs contradict each other, and what `start` had learned already."""
    log, input_name, settings = given
    evidence = learned.evidence
    runs = [run.run for run in drive]
    if evidence is None:
        evidence = evidence_of(runs, settings.segment.unknown_after)
    seen = Seen(
        evidence=evidence,
        runs=[run.name for run in runs],
        input_name=input_name,
        positions=has_course(log.runs),
        gyro=has_course(log.runs) or gyro_alone(log.runs),
        sensor=settings.sensor_extrinsics.pose,
        commanded=Commanded.of(log.runs),
    )
    unknown_after = settings.segment.unknown_after
    first = findings_in(seen)
    sensor = PoseSensor(*seen.sensor[1:], seen.positions)
    together = () if seen.commanded.throttle else unlike_logs(evidence.windows, runs, input_name, sensor)
    return (
        *first,
        *together,
        *findings_of_others(log, input_name, unknown_after, first),
        *findings_of_log(WholeLog(log, input_name, unknown_after)),
        *learned_before(log, start),
    )


def judged_content(
    learned: Learned,
    windows: WindowSet,
    given: tuple[Log, str, Settings],
    found: tuple[Finding, ...],
) -> tuple[Judged, schema.ModelFile]:
    """Judge what was learned; also what its model file holds."""
    log, input_name, settings = given
    sensors = Sensors(has_wheels(windows.drive), log.advice.get("wheel", ""), gyro_alone(log.runs))
    facts = _facts(learned, windows, given, found)
    judged = judge(to_judge(learned, settings, sensors, positions=facts.positions), facts)
    segments, seconds = len(windows), float(np.sum(windows.end - windows.start))
    if learned.sources:  # windows are those of the first source alone
        segments = sum(source.segments for source in learned.sources)
        seconds = windows.length * segments
    origin = ModelFacts(
        input_name=input_name,
        settings=settings,
        logs=[
            schema.LogReference(path=source.path, sha256=source.sha256)
            for source in used_sources(log, input_name)
        ],
        range=_range(windows.drive),
        seconds=seconds,
        segments=segments,
        positions=facts.positions,
        scale=log.scales.get(input_name),
    )
    return judged, model_content(learned, judged, origin)


def _by_learner(settings: Settings, windows: WindowSet, progress: Progress | None) -> Learned:
    """Learn in one pass, which also makes the predictions that are judged."""
    keep = Keep(settings.wheel_separation)
    return learn_log(windows.drive, settings, JUDGING_HORIZONS, keep=keep, progress=progress)


def _by_estimator(settings: Settings, windows: WindowSet, progress: Progress | None) -> Learned:
    """Learn with one of the estimators that the learner is compared with."""
    if settings.body_force.learned:
        raise SettingsError(
            "a body force is learned by the average of bases alone", advice=f"estimator = {AVERAGE!r}"
        )
    if any(run.run.commands is not None and run.run.commands.car is not None for run in windows.drive):
        raise SettingsError(
            "throttle and steering are learned by the average of bases alone",
            advice=f"estimator = {AVERAGE!r}",
        )
    learn = estimator_info(settings.estimator).run
    run = learn(settings, windows.drive[0].input_name, windows, record=True, progress=progress)
    predictor = Predictor("learned", settings.filter_settings().noise.shape, run.posterior, run.dynamics)
    sets = [collect_windows(windows.drive, horizon, settings.rules()) for horizon in JUDGING_HORIZONS]
    predictions = predict_all(predictor, windows, sets)
    plain = tuple(predictions_of(baseline_predictor(settings), windows, targets) for targets in sets)
    students = {p.horizon: final_student(p) for p in predictions if len(p)}
    kept = run.kept()
    return Learned(kept, kept, predictions, plain, students, run.history(), run.bases)


def learning_windows(drive: tuple[PreparedRun, ...], input_name: str, settings: Settings) -> WindowSet:
    """Cut the windows to learn from: of the length in the settings, or whole frames that are shorter."""
    settings = for_positions(settings) if has_course(run.run for run in drive) else settings
    rules = replace(settings.rules(), whole_frames=True)
    return collect_windows(drive, settings.segment_length(input_name), rules)


def refuse_empty(windows: WindowSet, log: Log) -> None:
    """Raise LogError where there is no window at all, saying why."""
    if len(windows):
        return
    reasons = "; ".join(f"{item.count} x {item.reason}" for item in windows.left_out)
    where = ", ".join(source.path for source in log.sources[:3])
    silent = silence(windows)
    if silent is not None:
        what = f"the log has no window to learn from: {silent[0]} ({reasons})"
        raise LogError(what, where=where, advice=silent[1])
    still = {item.kind for item in windows.left_out} - {"late-pose"} == {"standing-still"}
    raise LogError(
        "the robot never moves in this log" if still else "the log has no window to learn from",
        where=where,
        advice=reasons
        or frames_apart(log)
        or f"poses and inputs must overlap for at least {windows.length:g} s; see `slipwise inspect`",
    )


def notes_of(
    learned: Learned, log: Log, found: Iterable[Finding], mounts: Iterable[Mount]
) -> tuple[str, ...]:
    """Return what is said of a log beside its verdict, with its further sources, gyro and what was found."""
    gyro = gyro_clock(log.runs)
    placed = {mount.name for mount in mounts}
    return (
        *log.notes,
        *(" ".join((f"{each.sentence}.", *each.advice)) for each in found if not each.judged),
        *(source.sentence(placed=source.name in placed) for source in learned.sources),
        *(said for mount in mounts if (said := mount.untold())),
        *((gyro.sentence(),) if gyro is not None and gyro.sentence() else ()),
    )


def learned_mounts(learned: Learned, log: Log, settings: Settings) -> tuple[Mount, ...]:
    """Where sources of poses sit beside the first, where some were learned from."""
    return mounts_of(log.runs, settings.sensor_extrinsics.pose) if learned.sources else ()


def model_of(
    content: schema.ModelFile, log: Log, found: tuple[Finding, ...], mounts: tuple[Mount, ...] = ()
) -> Model:
    """Make the model of a log, of which `found` is what contradicts itself, with what it tells of mounts.

    Raises:
        LogError: no model has such parameters; such a log may lead to them.
    """
    try:
        return holding_mounts(Model(content), mounts)
    except ModelError as problem:
        raise LogError(
            f"no robot explains this log: {'; '.join(each.sentence for each in found) or problem.what}",
            where=", ".join(source.path for source in log.sources[:3]),
            advice=" ".join(text for each in found for text in each.advice)
            or "check that poses and inputs are of one drive, in m, rad, m/s and rad/s",
        ) from problem


def _facts(
    learned: Learned, windows: WindowSet, given: tuple[Log, str, Settings], found: tuple[Finding, ...]
) -> LogFacts:
    """What the log says about a verdict."""
    log, input_name, settings = given
    shortage: tuple[str, ...] = ()
    if too_short(len(learned.predictions[learned.judged])):
        shortest = collect_windows(windows.drive, JUDGING_HORIZONS[0], settings.rules())
        shortage = shortage_advice(log, input_name, shortest, settings)
    return LogFacts(found, shortage, input_name, has_course(log.runs), log.clocks_compared)


def _range(drive: tuple[PreparedRun, ...]) -> schema.Range:
    cars = [run.inputs.car for run in drive]  # their throttle and steering stand for speed and yaw rate here
    given = [
        (run.inputs.v, run.inputs.omega) if car is None else (car.throttle, car.steering)
        for run, car in zip(drive, cars, strict=True)
    ]
    speed, yaw_rate = (np.concatenate(axis) for axis in zip(*given, strict=True))
    sideways = np.concatenate([run.inputs.vy for run in drive])
    tilts = np.concatenate([attitude_rows(run.run)[:, 1:] for run in drive])
    wheels = WheelStep()
    for run in drive:
        if run.run.wheels is not None:
            wheels.take_run(run.run.wheels.t)
    return schema.Range(
        speed=[float(speed.min()), float(speed.max())],
        yaw_rate=[float(yaw_rate.min()), float(yaw_rate.max())],
        sideways=sideways_span(speed, sideways),
        slope=float(np.abs(tilts).max(initial=0.0)),
        wheel_step=wheels.seconds,
    )
