# SPDX-License-Identifier: Apache-2.0
"""How far a body went in the windows of a log, along its own heading, however it turned on the way.

Of poses the core sums it up from one to the next. Of positions alone there is the chord, which is shorter
than the way, most where the turning changes within it: the heading follows a cubic, whose slopes at both ends
are the mean yaw rates of either side.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

RUN, START, DURATION, DISTANCE, TURN, AHEAD, LEFT = 0, 1, 3, 4, 6, 17, 18  # columns of `_core` rows
SAME = 1e-3  # s between the end of a window and the start of the next
_SHORTEST = 0.5  # of the way, below which a chord does not tell it
_NODES, _WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(8))


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


def ways_ahead(rows: Floats, sensor_yaw: float) -> Floats:
    """Return how far the pose sensor, turned by `sensor_yaw` [rad], went along the robot's heading [m]."""
    ahead: Floats = np.cos(sensor_yaw) * rows[:, AHEAD] - np.sin(sensor_yaw) * rows[:, LEFT]
    return ahead
