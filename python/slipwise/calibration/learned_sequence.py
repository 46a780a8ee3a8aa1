# SPDX-License-Identifier: Apache-2.0
"""Logs of one robot pushed through one learner in their order: it remembers surfaces and recalls them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.learned_log import predictions_of, pushed
from slipwise.calibration.learner import Progress
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import PreparedRun
from slipwise.calibration.settings import Settings

_WORDS = {
    _core.SurfaceEventKind.Opened: "new",
    _core.SurfaceEventKind.Recalled: "recalled",
    _core.SurfaceEventKind.Kept: "kept",
    _core.SurfaceEventKind.Merged: "merged",
    _core.SurfaceEventKind.Dropped: "dropped",
}


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


@dataclass(frozen=True, eq=False)
class VisitedLog:
    """One log of a sequence."""

    predictions: tuple[Predictions, ...]  # one for each horizon
    surface: str  # on which it ended; empty where that was open
    changes: tuple[SurfaceChange, ...]


@dataclass(frozen=True, eq=False)
class LearnedSequence:
    """What a learner made of a sequence of logs."""

    logs: tuple[VisitedLog, ...]
    surfaces: tuple[SurfaceSummary, ...]


def learn_sequence(
    drives: Sequence[tuple[PreparedRun, ...]],
    settings: Settings,
    horizons: Sequence[float],
    *,
    progress: Progress | None = None,
) -> LearnedSequence:
    """Push logs through one learner; each begins on a surface that is remembered, or on a new one.

    Args:
        drives: the runs of each log, in the order of time.
        settings: what to learn and how.
        horizons: of the predictions [s].
        progress: called with the fraction done, 0 to 1.

    Raises:
        SettingsError: a basis or a term is unknown.
    """
    core = core_settings(settings, drives[0][0].input_name, horizons, remember=True)
    learner, visited = _core.MotionLearner(core), []
    runs: tuple[PreparedRun, ...] = ()
    learner.surface_events()
    for place, drive in enumerate(drives):
        learner.start_drive("", "")
        runs += drive
        held_out: list[list[_core.HeldOutPrediction]] = [[] for _ in horizons]
        for done in pushed(learner, drive):
            for event in learner.events():
                if event.prediction is not None:
                    held_out[event.prediction.horizon].append(event.prediction)
            if progress is not None:
                progress((place + done) / len(drives))
        bank = learner.surfaces()
        visited.append(
            VisitedLog(
                predictions_of(held_out, horizons, runs)[0],
                "" if bank.present is None else bank.surfaces[bank.present].name,
                tuple(_change(event) for event in learner.surface_events()),
            )
        )
    return LearnedSequence(tuple(visited), tuple(summary_of(each) for each in learner.surfaces().surfaces))


def summary_of(surface: _core.Surface) -> SurfaceSummary:
    """Return what there is to say of a surface."""
    speed, yaw_rate = surface.speeds
    return SurfaceSummary(
        surface.name, surface.seconds, surface.segments, surface.visits, surface.last_seen, speed, yaw_rate
    )


def _change(event: _core.SurfaceEvent) -> SurfaceChange:
    return SurfaceChange(_WORDS[event.kind], event.name, event.other, event.probability, event.segments)
