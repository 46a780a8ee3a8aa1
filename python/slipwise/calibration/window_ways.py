# SPDX-License-Identifier: Apache-2.0
"""How far a body went in the windows of a log, along its own heading, however it turned on the way.

A chord is shorter than the way, and it is shortest where the turning changes within it: between two poses the
heading follows a cubic, whose slopes at both ends are the mean yaw rates of either side. Where the poses
themselves are at hand, the way is the sum over all of them, which is short of nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Poses, Run

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

RUN, START, DURATION, DISTANCE, COURSE, TURN, START_YAW = 0, 1, 3, 4, 5, 6, 8  # columns of `_core` rows
SAME = 1e-3  # s between the end of a window and the start of the next, or a pose of either
_SHORTEST = 0.5  # of the way, below which a chord does not tell it
_NODES, _WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(8))


@dataclass(frozen=True, eq=False)
class Chords:
    """Straight lines between poses that follow each other, N of them."""

    duration: Floats  # [N] s
    distance: Floats  # [N] m
    course: Floats  # [N] rad
    turn: Floats  # [N] rad
    start_yaw: Floats  # [N] rad, of the robot
    follows: Bools  # [N] each begins where the one before ends

    def ahead(self) -> Floats:
        """Return the ways [N] along the heading [m]; NaN where a chord does not tell it."""
        shape = chord_per_way(self.turn, self.duration, self.follows)
        heading = self.course - self.start_yaw - np.angle(shape)
        return self.distance / np.abs(shape) * np.cos(heading)


def chord_per_way(turn: Floats, duration: Floats, follows: Bools) -> NDArray[np.complex128]:
    """Return chords over ways [N], seen from the first heading; NaN where the chord is too short to tell."""
    rate = turn / duration
    second = np.flatnonzero(follows)
    begin, end = rate.copy(), rate.copy()
    begin[second] = end[second - 1] = 0.5 * (rate[second - 1] + rate[second])
    s = (0.5 + _NODES)[:, None]
    bends = s * (1.0 - s) ** 2 * begin - s**2 * (1.0 - s) * end
    yaw = s**2 * (3.0 - 2.0 * s) * turn + bends * duration
    shape: NDArray[np.complex128] = (_WEIGHTS[:, None] * np.exp(1j * yaw)).sum(axis=0)
    return np.where(np.abs(shape) < _SHORTEST, np.nan, shape)


def follows_before(rows: Floats) -> Bools:
    """Say which windows [M] begin where the one before ends."""
    ends = rows[:, START] + rows[:, DURATION]
    follows = np.zeros(len(rows), dtype=np.bool_)
    follows[1:] = (rows[1:, RUN] == rows[:-1, RUN]) & (np.abs(rows[1:, START] - ends[:-1]) < SAME)
    return follows


def ways_ahead(rows: Floats, runs: Sequence[Run], sensor_yaw: float) -> Floats:
    """Return how far the pose sensor went along the robot's heading in each window [m].

    Args:
        rows: windows, as `_core.MotionEvidence` has them.
        runs: whose windows these are; of those without poses the windows themselves say it.
        sensor_yaw: how the pose sensor is known to be turned [rad].
    """
    ahead = Chords(
        duration=rows[:, DURATION],
        distance=rows[:, DISTANCE],
        course=rows[:, COURSE],
        turn=rows[:, TURN],
        start_yaw=rows[:, START_YAW] - sensor_yaw,
        follows=follows_before(rows),
    ).ahead()
    for number, run in enumerate(runs):
        own = np.flatnonzero(rows[:, RUN] == number)
        if len(own) and len(run.poses) > 1:
            found = _between(run.poses, rows[own, START], rows[own, DURATION], sensor_yaw)
            ahead[own] = np.where(np.isnan(found), ahead[own], found)
    return ahead


def _between(poses: Poses, start: Floats, duration: Floats, sensor_yaw: float) -> Floats:
    """Return the ways over all poses of windows; NaN where the windows do not begin and end at some."""
    dx, dy, yaw = np.diff(poses.x), np.diff(poses.y), np.unwrap(poses.yaw)
    whole = np.diff(poses.frame) == 0
    steps = Chords(
        duration=np.diff(poses.t),
        distance=np.hypot(dx, dy),
        course=np.arctan2(dy, dx),
        turn=np.diff(yaw),
        start_yaw=yaw[:-1] - sensor_yaw,
        follows=np.concatenate(([False], whole[1:] & whole[:-1])),
    ).ahead()
    known = whole & np.isfinite(steps)
    way = np.concatenate(([0.0], np.cumsum(np.where(known, steps, 0.0))))
    unknown = np.concatenate(([0], np.cumsum(~known)))
    first, last = (_nearest(poses.t, each) for each in (start, start + duration))
    met = (np.abs(poses.t[first] - start) < SAME) & (np.abs(poses.t[last] - start - duration) < SAME)
    return np.where(met & (unknown[first] == unknown[last]), way[last] - way[first], np.nan)


def _nearest(stamps: Floats, t: Floats) -> NDArray[np.intp]:
    after = np.clip(np.searchsorted(stamps, t), 1, len(stamps) - 1)
    return np.where(t - stamps[after - 1] < stamps[after] - t, after - 1, after)
