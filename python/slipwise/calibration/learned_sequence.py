# SPDX-License-Identifier: Apache-2.0
"""Logs of one robot pushed through one learner in their order: it remembers surfaces and recalls them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from slipwise import _core
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import (
    LEARNED,
    Cue,
    Keep,
    learned_of,
    new_learner,
    predictions_of,
    pushed,
)
from slipwise.calibration.learner import Progress
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import PreparedRun, has_wheels
from slipwise.calibration.settings import Settings
from slipwise.calibration.surface_course import SurfaceCourse, course_of
from slipwise.calibration.surface_labels import date_of, label_at_start, labels_of
from slipwise.calibration.surface_sections import begin_with
from slipwise.errors import LogError
from slipwise.models.model import Model
from slipwise.terrain.label_file import Window

_WORDS = {
    _core.SurfaceEventKind.Opened: "new",
    _core.SurfaceEventKind.Recalled: "recalled",
    _core.SurfaceEventKind.Kept: "kept",
    _core.SurfaceEventKind.Merged: "merged",
    _core.SurfaceEventKind.Dropped: "dropped",
}
Labels = Mapping[str, Sequence[Window]]


@dataclass(frozen=True)
class SurfaceSummary:
    """A surface that is remembered."""

    name: str
    seconds: float  # driven on it
    segments: int  # learned on it
    visits: int
    last_seen: str  # date, where it was given
    speed: float  # m/s, which 90 % of the driving stayed below
    yaw_rate: float  # rad/s, the same


@dataclass(frozen=True)
class SurfaceChange:
    """Something that happened to the memory while a log was driven."""

    what: str  # new, recalled, kept after a suspicion, merged, or dropped
    name: str  # of the surface; empty where it has none yet
    other: str  # what was merged into it
    probability: float  # of the surface, when it was taken
    segments: int  # that spoke before
    run: int = 0  # index in its log
    t: float = float("nan")  # s, when it was decided; not a number before anything was measured


@dataclass(frozen=True, eq=False)
class VisitedLog:
    """One log of a sequence."""

    predictions: tuple[Predictions, ...]  # one for each horizon
    surface: str  # on which it ended; empty where that was open
    changes: tuple[SurfaceChange, ...]
    course: SurfaceCourse | None = None


@dataclass(frozen=True, eq=False)
class LearnedSequence:
    """What a learner made of a sequence of logs."""

    logs: tuple[VisitedLog, ...]
    surfaces: tuple[SurfaceSummary, ...]
    labels: tuple[float, float]  # labels that were judged, and how many were right
    learner: _core.MotionLearner
    learned: Learned | None = None  # of all logs together, where it was asked


@dataclass(frozen=True)
class SequenceOptions:
    """What a sequence begins with, and what is wanted of it."""

    start: Model | None = None  # whose robot and surfaces are known
    labels: tuple[str, ...] = ()  # of each log; without them, those of its column `terrain`
    terrain: Labels | None = None  # what sensors said of each run's surface, in place of both
    keep: Keep | None = None  # what a model file needs beside predictions
    embargo: float | None = None  # s that parameters of predictions are old at least; None: one horizon
    start_file: str = ""  # of the model to begin with, for errors


_NOTHING = SequenceOptions()


def learn_sequence(
    drives: Sequence[tuple[PreparedRun, ...]],
    settings: Settings,
    horizons: Sequence[float],
    *,
    options: SequenceOptions = _NOTHING,
    progress: Progress | None = None,
) -> LearnedSequence:
    """Push logs through one learner; each begins on a surface that is remembered, or on a new one.

    Args:
        drives: the runs of each log, in the order of time.
        settings: what to learn and how.
        horizons: of the predictions [s].
        options: prior, labels and wanted results.
        progress: called with the fraction done, 0 to 1.

    Raises:
        SettingsError: a basis or a term is unknown, or not that of the model to begin with.
        LogError: what sensors said of the surface goes with no run.
        ModelError: the model to begin with has another input, or no memory of surfaces.
    """
    if options.terrain is not None:
        check_labels(options.terrain, drives)
    learner = _begun(drives, settings, horizons, options)
    visited: list[VisitedLog] = []
    runs: tuple[PreparedRun, ...] = ()
    learned: list[_core.LearnerEvent] = []
    learner.surface_events()
    for place, drive in enumerate(drives):
        cues = _begin_drive(learner, drive, place, options)
        runs += drive
        begun = partial(_share, progress, place, len(drives))
        columns, windows = _drive(learner, drive, horizons, cues, begun)
        visited.append(_visited(learner, predictions_of(columns, horizons, runs)[0], windows, runs))
        learned += windows if options.keep is not None else []
    bank = learner.surfaces()
    judged, right = bank.labels
    return LearnedSequence(
        tuple(visited),
        tuple(summary_of(each) for each in bank.surfaces),
        (judged, right),
        learner,
        None if options.keep is None else learned_of(learner, learned, horizons, runs, options.keep),
    )


def go_on(
    drives: Sequence[tuple[PreparedRun, ...]],
    settings: Settings,
    horizons: Sequence[float],
    *,
    embargo: float | None = None,
    progress: Progress | None = None,
) -> tuple[tuple[Predictions, ...], ...]:
    """Push logs through one learner without a memory of surfaces: what a memory has to beat.

    Args:
        drives: the runs of each log, in the order of time.
        settings: what to learn and how.
        horizons: of the predictions [s].
        embargo: how old the parameters of predictions are at least [s]; None: one horizon.
        progress: called with the fraction done, 0 to 1.

    Returns:
        The predictions of each log, one for each horizon.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    runs = tuple(run for drive in drives for run in drive)
    learner = new_learner([run.run for run in runs], runs[0].input_name, settings, horizons, embargo=embargo)
    found = []
    for place, drive in enumerate(drives):
        columns, _ = _drive(learner, drive, horizons, (), partial(_share, progress, place, len(drives)))
        found.append(predictions_of(columns, horizons, runs)[0])
    return tuple(found)


def _drive(
    learner: _core.MotionLearner,
    drive: tuple[PreparedRun, ...],
    horizons: Sequence[float],
    cues: Sequence[tuple[Cue, ...]],
    progress: Progress,
) -> tuple[list[_core.HeldOutColumns], list[_core.LearnerEvent]]:
    """Push a log; return what was predicted at each horizon, and what was learned."""
    held_out: list[list[_core.HeldOutPrediction]] = [[] for _ in horizons]
    windows: list[_core.LearnerEvent] = []
    for done in pushed(learner, drive, cues):
        for event in learner.events():
            if event.prediction is not None:
                held_out[event.prediction.horizon].append(event.prediction)
            elif event.kind == LEARNED:
                windows.append(event)
        progress(done)
    return [_core.HeldOutColumns(each) for each in held_out], windows


def _share(progress: Progress | None, place: int, count: int, done: float) -> None:
    if progress is not None:
        progress((place + done) / count)


def _begun(
    drives: Sequence[tuple[PreparedRun, ...]],
    settings: Settings,
    horizons: Sequence[float],
    options: SequenceOptions,
) -> _core.MotionLearner:
    input_name = drives[0][0].input_name
    runs = [run.run for drive in drives for run in drive]
    learner = new_learner(runs, input_name, settings, horizons, remember=True, embargo=options.embargo)
    if options.start is not None:
        wheels = any(has_wheels(drive) for drive in drives)
        begin_with(learner, options.start, input_name, wheels=wheels, where=options.start_file)
    return learner


def _begin_drive(
    learner: _core.MotionLearner, drive: tuple[PreparedRun, ...], place: int, options: SequenceOptions
) -> Sequence[tuple[Cue, ...]]:
    """Begin a log; return the labels of the surface in each run."""
    if options.terrain is not None:
        learner.start_drive("", date_of(drive))
        return [cues_of(options.terrain, run) for run in drive]
    label = options.labels[place] if options.labels else None
    cues = [labels_of(run.run) if label is None else () for run in drive]
    learner.start_drive(label or label_at_start(cues[0], drive[0].run), date_of(drive))
    return cues


def _visited(
    learner: _core.MotionLearner,
    predictions: tuple[Predictions, ...],
    windows: list[_core.LearnerEvent],
    runs: tuple[PreparedRun, ...],
) -> VisitedLog:
    bank = learner.surfaces()
    return VisitedLog(
        predictions,
        "" if bank.present is None else bank.surfaces[bank.present].name,
        tuple(change_of(event, runs[event.run].index) for event in learner.surface_events()),
        course_of(windows, [runs[each.run].index for each in windows], [_alarm(each) for each in windows]),
    )


def summary_of(surface: _core.Surface) -> SurfaceSummary:
    """Return what there is to say of a surface."""
    speed, yaw_rate = surface.speeds
    return SurfaceSummary(
        surface.name, surface.seconds, surface.segments, surface.visits, surface.last_seen, speed, yaw_rate
    )


def change_of(event: _core.DatedSurfaceEvent, run: int) -> SurfaceChange:
    """Return what happened; `run` is the index of its run in the log."""
    return SurfaceChange(
        _WORDS[event.kind],
        event.name,
        event.other,
        event.probability,
        event.segments,
        run,
        event.t,
    )


def _alarm(event: _core.LearnerEvent) -> bool:
    """Whether the way to learn that weighs most found a change of terrain."""
    heaviest = max(range(len(event.weights)), key=lambda place: event.weights[place])
    return bool(event.updates[heaviest].change.alarm)


def cues_of(labels: Labels, run: PreparedRun) -> tuple[Cue, ...]:
    """Return what was said while a run was driven, each when it was known: at its window's end."""
    first, last = run.run.span
    windows = labels.get(run.run.name, ())
    return tuple((each.end, each.answer) for each in windows if first <= each.end <= last)


def check_labels(labels: Labels, drives: Sequence[Sequence[PreparedRun]]) -> None:
    """Refuse labels that go with no run, or with several.

    Raises:
        LogError: no run has labels, the labels of one lie at other times than it was driven, or two logs
            have a run of one name at the same times.
    """
    runs = [run.run for drive in drives for run in drive]
    named = [run for run in runs if run.name in labels]
    if not named:
        raise LogError(
            f"the labels are of runs {_some(sorted(labels))}, the logs have {_some([r.name for r in runs])}",
            where="--surface",
            advice="name the runs alike in both, in the column `run`",
        )
    for place, run in enumerate(named):
        windows, (first, last) = labels[run.name], run.span
        if not any(first <= window.end <= last for window in windows):
            raise LogError(
                f"run {run.name} was driven from {first:.1f} to {last:.1f} s and its labels are from "
                f"{windows[0].start:.1f} to {windows[-1].end:.1f} s",
                where="--surface",
                advice="stamp both by one clock",
            )
        for other in named[:place]:
            if other.name == run.name and other.span[0] <= last and first <= other.span[1]:
                raise LogError(
                    f"two logs have a run {run.name} at the same times, and labels of one",
                    where="--surface",
                    advice="name the runs differently in the column `run`",
                )


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:3])
    return f"{shown} and {len(names) - 3} more" if len(names) > 3 else shown
