# SPDX-License-Identifier: Apache-2.0
"""Finds poses that only integrate the wheels, as `/odom` does: nothing can be learned of slip from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from slipwise import _core
from slipwise.logs.contradiction import Contradiction
from slipwise.logs.dead_reckoning import dead_reckoned
from slipwise.logs.log import Floats, Inputs, Poses
from slipwise.logs.motion_windows import wrapped

_LENGTH, _LONGEST = 1.0, 1.6  # [s] of the windows
_MOST_WINDOWS = 400  # of a run
_MOST_RUNS = 10  # spread over the log
_MOVING = 0.05  # [m] by the wheels
_ENOUGH = 10  # windows
_APART = 0.3  # [s] the clocks of poses and wheels are tried apart by at most this,
_STEPS = (0.005, 0.0005)  # [s] in coarse steps, then in fine ones
_SAME_HEADING = 3e-4  # [rad] no sensor of headings is better over a second,
_SAME_TURN = 1e-3  # and no wheels turn a robot by what they say so exactly
_SAME_WAY = 3e-3  # of the distance along the heading; how wheels are integrated changes as much
_SAME_PLACE = 1e-2  # of the distance; the same


@dataclass(frozen=True)
class _Difference:
    """Medians over the windows of how far poses are from the wheels' own path."""

    place: float  # [m]
    way: float  # [m] along the heading
    heading: float  # [rad]
    distance: float  # [m] driven
    turn: float  # [rad]

    @property
    def none(self) -> bool:
        """Whether it is far below any sensor's noise and any slip."""
        by_heading = self.heading < _SAME_HEADING and self.heading <= _SAME_TURN * max(self.turn, 0.1)
        return (
            by_heading and self.way < _SAME_WAY * self.distance and self.place < _SAME_PLACE * self.distance
        )


def repeated_wheels(pairs: Sequence[tuple[Inputs, Poses]]) -> Contradiction | None:
    """Say whether the poses are the wheels' own path.

    Simulators whose robots slip have poses of their own, however exact they are.

    Args:
        pairs: wheels and poses of each run.
    """
    spread = pairs[:: max(1, len(pairs) // _MOST_RUNS)]
    runs = [run for wheels, poses in spread if (run := _Run.of(wheels, poses)) is not None]
    if sum(len(run.first) for run in runs) < _ENOUGH:
        return None
    found = _least(runs)
    if found is None or not found.none:
        return None
    return Contradiction(
        "repeated-wheels",
        "the poses carry no information of their own: over a second they follow the wheels' own path to "
        f"{max(1e3 * found.place, 0.01):.2g} mm and less than {_SAME_HEADING} rad, which no sensor could",
        (
            "They integrate the wheels, as /odom does, and show no slip.",
            "Record poses of another source: lidar, RTK, motion capture; in a simulator, its ground truth.",
        ),
    )


@dataclass(frozen=True, eq=False)
class _Run:
    """The windows of one run, and the path of its wheels."""

    path: Poses
    path_yaw: Floats  # unwrapped
    poses: Poses
    first: np.ndarray  # indices of poses
    last: np.ndarray

    @classmethod
    def of(cls, wheels: Inputs, poses: Poses) -> _Run | None:
        if len(wheels) < 3 or len(poses) < 3:
            return None
        last = np.searchsorted(poses.t, poses.t + _LENGTH - _core.SAME_STAMP)
        first = np.flatnonzero(last < len(poses))
        last = last[first]
        whole = (poses.frame[first] == poses.frame[last]) & (
            poses.t[last] - poses.t[first] < _LONGEST - _core.SAME_STAMP
        )
        spread = slice(None, None, max(1, int(whole.sum()) // _MOST_WINDOWS))
        path = dead_reckoned(wheels)
        return cls(path, np.unwrap(path.yaw), poses, first[whole][spread], last[whole][spread])

    def motions(self, offset: float) -> tuple[Floats, Floats]:
        """Return the windows' motions by the poses and by the wheels `offset` [s] earlier, [N, 3] each."""
        poses, path = self.poses, self.path
        times = poses.t[self.first] - offset, poses.t[self.last] - offset
        inside = (times[0] >= path.t[0]) & (times[1] <= path.t[-1])
        ends = [
            np.column_stack([np.interp(t[inside], path.t, c) for c in (path.x, path.y, self.path_yaw)])
            for t in times
        ]
        measured = [
            np.column_stack((poses.x, poses.y, poses.yaw))[k[inside]] for k in (self.first, self.last)
        ]
        return _motion(*measured), _motion(*ends)


def _least(runs: Sequence[_Run]) -> _Difference | None:
    """The difference at the offset between the clocks at which it is least."""
    middle, reach, least = 0.0, _APART, None
    for step in _STEPS:
        offsets = (middle + np.arange(-reach, reach + 0.5 * step, step)).tolist()
        tried = [(each, offset) for offset in offsets if (each := _at(runs, offset)) is not None]
        if not tried:
            return None
        least, middle = min(tried, key=lambda pair: pair[0].place + pair[0].heading)
        reach = step
    return least


def _at(runs: Sequence[_Run], offset: float) -> _Difference | None:
    both = [run.motions(offset) for run in runs]
    poses, wheels = (np.vstack([pair[k] for pair in both]) for k in (0, 1))
    distance = np.hypot(wheels[:, 0], wheels[:, 1])
    moving = distance > _MOVING
    if int(moving.sum()) < _ENOUGH:
        return None
    apart = (poses - wheels)[moving]
    return _Difference(
        place=float(np.median(np.hypot(apart[:, 0], apart[:, 1]))),
        way=float(np.median(np.abs(apart[:, 0]))),
        heading=float(np.median(np.abs(wrapped(apart[:, 2])))),
        distance=float(np.median(distance[moving])),
        turn=float(np.median(np.abs(wheels[moving, 2]))),
    )


def _motion(start: Floats, end: Floats) -> Floats:
    """The second of two poses seen from the first, [N, 3]."""
    step = end - start
    c, s = np.cos(start[:, 2]), np.sin(start[:, 2])
    return np.column_stack((c * step[:, 0] + s * step[:, 1], c * step[:, 1] - s * step[:, 0], step[:, 2]))
