# SPDX-License-Identifier: Apache-2.0
"""Short windows in which what the poses did can be compared with what the inputs said."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from slipwise import _core
from slipwise.logs.held import HeldSum
from slipwise.logs.log import Floats, Inputs, Poses

_LENGTH = 1.5  # [s]
_LONGEST = 4.0  # [s] poses may be missing for a while
_KNOWN_PART = 0.9  # of a window's time, inputs must be known


@dataclass(frozen=True, eq=False)
class MotionWindows:
    """Poses against inputs in N windows."""

    run: Floats  # [N] number of the pair of inputs and poses
    start: Floats  # [N] s, stamp of the first pose
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


def motion_windows(pairs: Sequence[tuple[Inputs, Poses]], unknown_after: float) -> MotionWindows:
    """Cut all runs into windows of about 1.5 s inside one frame and with known inputs.

    An input is unknown once it is older than `unknown_after` [s].
    """
    parts = [
        _windows(k, inputs, poses, unknown_after) for k, (inputs, poses) in enumerate(pairs) if len(poses) > 1
    ]
    names = [column.name for column in fields(MotionWindows)]
    columns = {
        name: np.concatenate([np.empty(0), *(getattr(part, name) for part in parts)]) for name in names
    }
    return MotionWindows(**columns)


def wrapped(angle: Floats, turn: float = 2.0 * np.pi) -> Floats:
    """Wrap angles [N] to half a turn on either side of 0."""
    return np.asarray((angle + 0.5 * turn) % turn - 0.5 * turn)


def _windows(number: int, inputs: Inputs, poses: Poses, unknown_after: float) -> MotionWindows:
    new_frame = np.flatnonzero(np.diff(poses.frame, prepend=-1))
    start_time = poses.t[new_frame][np.searchsorted(new_frame, np.arange(len(poses)), side="right") - 1]
    slot = np.floor((poses.t - start_time + _core.SAME_STAMP) / _LENGTH)
    first = np.flatnonzero((np.diff(slot, prepend=-1.0) != 0.0) | (np.diff(poses.frame, prepend=-1) != 0))
    i, j = first[:-1], first[1:]
    duration = poses.t[j] - poses.t[i]
    v, vy, omega = (
        HeldSum.of(inputs, values, unknown_after) for values in (inputs.v, inputs.vy, inputs.omega)
    )
    good = (poses.frame[i] == poses.frame[j]) & (duration < _LONGEST - _core.SAME_STAMP)
    good &= v.known(poses.t[i], poses.t[j]) > _KNOWN_PART * duration + _core.SAME_STAMP
    i, j = i[good], j[good]
    step = np.diff(poses.yaw, prepend=poses.yaw[:1])
    followed, followed_degrees = np.cumsum(wrapped(step)), np.cumsum(wrapped(step, 360.0))
    dx, dy = poses.x[j] - poses.x[i], poses.y[j] - poses.y[i]
    return MotionWindows(
        run=np.full(len(i), float(number)),
        start=poses.t[i],
        duration=duration[good],
        distance=np.hypot(dx, dy),
        course=np.arctan2(dy, dx),
        turn=followed[j] - followed[i],
        turn_degrees=followed_degrees[j] - followed_degrees[i],
        start_yaw=poses.yaw[i],
        forward=v.between(poses.t[i], poses.t[j]),
        sideways=vy.between(poses.t[i], poses.t[j]),
        rotation=omega.between(poses.t[i], poses.t[j]),
    )
