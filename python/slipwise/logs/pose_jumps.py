# SPDX-License-Identifier: Apache-2.0
"""Finds poses that jump further than the robot can have moved; drops lone ones, splits frames at others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.logs.held import HeldSum
from slipwise.logs.log import Bools, Inputs, Ints, Poses
from slipwise.logs.motion_windows import wrapped
from slipwise.logs.streams import order_codes

_LATE = 1.0  # [s] poses may be late or early by this much,
_BUSY = 0.5  # [s] or by this much more than the time since the last one: a localiser that stalls is late
_SLIP = 1.1  # a robot may move this much further than its inputs say
_UNKNOWN = 1.5  # and where there are no inputs, this much faster than it ever was told to go
_DISTANCE = 0.5  # [m] on top of that, before it is called a jump
_ANGLE = 0.8  # [rad]
_WHOLE_TURNS = (
    4.0 * np.pi
)  # [rad] a heading is wrapped by one turn at most; a larger step is a fault in any case
_NOISE = 8.0  # standard deviations of the poses' own noise
_LONGEST_OUTLIER = 3  # poses
_BEND_OF_NOISE = 1.652  # median of |second difference| for a standard deviation of 1: 0.6745 sqrt(1 + 4 + 1)


@dataclass(frozen=True, eq=False)
class Jumps:
    """What was found: poses to drop, and poses that start a new frame."""

    dropped: Bools  # [M]
    starts: Bools  # [M]


def find_jumps(poses: Poses, inputs: Inputs, unknown_after: float) -> Jumps:
    """Compare every step between poses of one frame with what the inputs allow, 1 s early or late.

    An input is unknown once it is older than `unknown_after` [s].
    """
    reach = _Reach(poses, inputs, unknown_after)
    dropped, starts = np.zeros(len(poses), bool), np.zeros(len(poses), bool)
    i = np.arange(len(poses) - 1)
    for step in np.flatnonzero(reach.jumps(i, i + 1)).tolist():
        if dropped[step]:
            continue
        after = np.arange(step + 2, min(step + 2 + _LONGEST_OUTLIER, len(poses)))
        back = after[(poses.frame[after] == poses.frame[step])]
        home = back[~reach.jumps(np.full(len(back), step), back) & _returns(poses, step, back)]
        if len(home):
            dropped[step + 1 : home[0]] = True
        else:
            starts[step + 1] = True
    return Jumps(dropped, starts & ~dropped)


def _returns(poses: Poses, step: int, back: Ints) -> Bools:
    """Say whether the poses `back` [K] lie far nearer to where the step began than where it ended."""
    ends = np.concatenate([[step + 1], back])
    distance = np.hypot(poses.x[ends] - poses.x[step], poses.y[ends] - poses.y[step])
    angle = np.abs(wrapped(poses.yaw[ends] - poses.yaw[step]))
    near = distance[1:] < 0.5 * max(distance[0], _DISTANCE)
    return np.asarray(near & (angle[1:] < 0.5 * max(angle[0], _ANGLE)))


def without_jumps(poses: Poses, jumps: Jumps) -> Poses:
    """Drop the lone outliers, and give the poses after each lasting jump a frame of their own."""
    keep = ~jumps.dropped
    split = poses.frame * (int(jumps.starts.sum()) + 1) + np.cumsum(jumps.starts)
    others = {name: None if values is None else values[keep] for name, values in poses.optional().items()}
    return Poses(
        t=poses.t[keep],
        x=poses.x[keep],
        y=poses.y[keep],
        yaw=poses.yaw[keep],
        frame=order_codes(split[keep]),
        **others,
    )


class _Reach:
    """How far the robot can have come between two poses."""

    def __init__(self, poses: Poses, inputs: Inputs, unknown_after: float) -> None:
        speed, rate = np.hypot(inputs.v, inputs.vy), np.abs(inputs.omega)
        self._poses = poses
        self._path = HeldSum.of(inputs, speed, unknown_after)
        self._turn = HeldSum.of(inputs, rate, unknown_after)
        self._top_speed, self._top_rate = float(speed.max()), float(rate.max())
        self._margin = max(_DISTANCE, _NOISE * _noise(poses))

    def jumps(self, i: Ints, j: Ints) -> Bools:
        """Say whether pose j [K] is out of reach from pose i [K]."""
        p = self._poses
        late = np.maximum(_LATE, _BUSY + p.t[j] - p.t[i])
        start, stop = p.t[i] - late, p.t[j] + late
        unknown = _UNKNOWN * np.maximum(p.t[j] - p.t[i] - self._path.known(p.t[i], p.t[j]), 0.0)
        path = _SLIP * self._path.between(start, stop) + self._top_speed * unknown
        turn = _SLIP * self._turn.between(start, stop) + self._top_rate * unknown
        far = np.hypot(p.x[j] - p.x[i], p.y[j] - p.y[i]) > path + self._margin
        step = p.yaw[j] - p.yaw[i]
        turned = (np.abs(wrapped(step)) > turn + _ANGLE) | (np.abs(step) > turn + _WHOLE_TURNS)
        return np.asarray((far | turned) & (p.frame[i] == p.frame[j]))


def _noise(poses: Poses) -> float:
    """Return the standard deviation of a coordinate [m], from second differences: 0 for a smooth track."""
    if len(poses) < 5:
        return 0.0
    return max(float(np.median(np.abs(np.diff(axis, n=2)))) for axis in (poses.x, poses.y)) / _BEND_OF_NOISE
