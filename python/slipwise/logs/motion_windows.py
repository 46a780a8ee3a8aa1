# SPDX-License-Identifier: Apache-2.0
"""Short windows in which what the poses did can be compared with what the inputs said, cut by the core."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from slipwise import _core
from slipwise.logs.gyro import COLUMN as GYRO
from slipwise.logs.log import Floats, Inputs, Poses, Run

_KNOWN_PART = 0.9  # of a window's time, inputs must be known
_NO_RATES = np.empty((0, 2))
_Streams: TypeAlias = tuple[Inputs | None, Inputs | None, Poses]
_POSES = 9  # columns of the core's rows that tell of poses; 4 of the commands and 4 of the wheels follow


@dataclass(frozen=True, eq=False)
class MotionWindows:
    """Poses against inputs in N windows of about 1.5 s, each inside one frame and with known inputs."""

    run: Floats  # [N] number of the run
    start: Floats  # [N] s, stamp of the first pose
    since: Floats  # [N] s from the first pose of the run to that
    duration: Floats  # [N] s
    distance: Floats  # [N] m, between the first and the last pose
    course: Floats  # [N] rad, direction of that line
    turn: Floats  # [N] yaw of the last minus the first, followed from pose to pose as radians
    turn_degrees: Floats  # [N] the same, followed as degrees
    start_yaw: Floats  # [N] as measured
    forward: Floats  # [N] integral of v
    sideways: Floats  # [N] integral of vy
    rotation: Floats  # [N] integral of omega

    def __len__(self) -> int:
        return len(self.duration)

    def course_ahead(self, sensor_yaw: float) -> Floats:
        """Return the course [N] along the heading amid each window, of a sensor that is turned so far."""
        return np.asarray(self.course - self.start_yaw - 0.5 * self.turn + sensor_yaw)


def motion_windows(rows: Floats, input_name: str) -> MotionWindows:
    """Return the windows in which one kind of input is known.

    Args:
        rows: of `_core.MotionEvidence`.
        input_name: "command" or "wheel".
    """
    first = _POSES if input_name == "command" else _POSES + 4
    poses, (*held, known) = rows[:, :_POSES].T, rows[:, first : first + 4].T
    good = known > _KNOWN_PART * rows[:, 3] + _core.SAME_STAMP
    return MotionWindows(*(column[good] for column in (*poses, *held)))


def run_name(runs: Sequence[str], number: float) -> str:
    """Return the name of a run by its number; an unnamed one has none."""
    return runs[int(number)] if number < len(runs) else ""


def evidence_of(
    runs: Iterable[Run], unknown_after: float, *, rates: Sequence[Floats] = ()
) -> _core.MotionEvidence:
    """Return what a learner would know of contradictions after these runs, which learns nothing itself.

    Args:
        runs: of a log.
        unknown_after: an input is unknown once it is older than this [s].
        rates: of a gyro that is learned from, rows of (t, yaw rate) for each run; none is.
    """
    streams = tuple((run.commands, run.wheels, run.poses.as_measured) for run in runs)
    return _evidence_with(streams, unknown_after, rates) if rates else _evidence(streams, unknown_after)


@lru_cache(maxsize=1)  # whoever reads a log looks at it, and whoever judges it afterwards does again
def _evidence(streams: tuple[_Streams, ...], unknown_after: float) -> _core.MotionEvidence:
    return _evidence_with(streams, unknown_after, [_NO_RATES] * len(streams))


def _evidence_with(
    streams: Sequence[_Streams], unknown_after: float, rates: Sequence[Floats]
) -> _core.MotionEvidence:
    settings = _core.StreamSettings()
    settings.unknown_after = unknown_after
    pairs = zip(streams, rates, strict=True)
    return _core.motion_evidence(settings, [_recording(*each, gyro) for each, gyro in pairs])


def measured_rows(runs: Iterable[Run], unknown_after: float) -> Floats:
    """Return rows of windows of poses as they were measured, whatever the unit of the inputs may be.

    The gates of a learner leave speeds out that no robot has: they are shown a thousandth.
    """
    slow = 1e-3
    rows = evidence_of([_slower(run, slow) for run in runs], unknown_after).measured_windows
    for first in (_POSES, _POSES + 4):
        rows[:, first : first + 3] /= slow
    return rows


def _slower(run: Run, factor: float) -> Run:
    commands, wheels = (
        None if i is None else replace(i, v=factor * i.v, vy=factor * i.vy, omega=factor * i.omega)
        for i in (run.commands, run.wheels)
    )
    return replace(run, commands=commands, wheels=wheels)


def _recording(
    commands: Inputs | None, wheels: Inputs | None, poses: Poses, rates: Floats
) -> _core.Recording:
    given, measured = (np.empty((0, 4)) if i is None else i.rows() for i in (commands, wheels))
    gyro = {GYRO: rates} if len(rates) else {}
    return _core.Recording(given, measured, np.empty((0, 3)), poses.rows(), gyro)


def wrapped(angle: Floats, turn: float = 2.0 * np.pi) -> Floats:
    """Wrap angles [N] to half a turn on either side of 0."""
    return np.asarray((angle + 0.5 * turn) % turn - 0.5 * turn)
