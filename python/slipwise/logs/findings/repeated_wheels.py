# SPDX-License-Identifier: Apache-2.0
"""Finds poses that only integrate the wheels, as `/odom` does: nothing can be learned of slip from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.motion_windows import wrapped

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_Evidence = _core.MotionEvidence | _core.RecentEvidence

_MOVING = 0.05  # [m] by the wheels
_ENOUGH = 10  # pairs of poses
_APART = 0.3  # [s] the clocks of poses and wheels are tried apart by at most this,
_STEPS = (0.02, 0.0025, 0.0005)  # [s] in coarse steps, then in finer ones around the best
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


class RepeatedWheels(Check):
    """Poses that are the wheels' own path.

    Simulators whose robots slip have poses of their own, however exact they are.
    """

    kind, family = "repeated-wheels", "topics"
    means = "the poses carry no information of their own: they integrate the wheels, as `/odom` does"
    shows = "over a second they follow the wheels to 0.0003 rad, 0.3 % along and 1 % across"
    cure = "`--pose-topic` of a lidar, RTK or motion capture; in a simulator, its ground truth"

    def look(self, seen: Seen) -> Finding | None:
        """Compare poses with the wheels' path at all offsets between their clocks."""
        found = _least(seen.evidence)
        if found is None or not found.none:
            return None
        return self.found(
            "the poses carry no information of their own: over a second they follow the wheels' own path to "
            f"{max(1e3 * found.place, 0.01):.2g} mm and less than {_SAME_HEADING} rad, which no sensor could",
            "They integrate the wheels, as /odom does, and show no slip.",
            "Record poses of another source: lidar, RTK, motion capture; in a simulator, its ground truth.",
            evidence=found.place,
        )


def _least(evidence: _Evidence) -> _Difference | None:
    """The difference at the offset between the clocks at which it is least."""
    middle, reach, least = 0.0, _APART, None
    for step in _STEPS:
        offsets, medians = _at(evidence, middle + np.arange(-reach, reach + 0.5 * step, step))
        if not len(offsets):
            return None
        best = int(np.argmin(medians[:, 0] + medians[:, 2]))
        least, middle, reach = _Difference(*medians[best].tolist()), float(offsets[best]), step
    return least


def _at(evidence: _Evidence, offsets: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Those of the offsets at which enough moved, [K], and the medians there, [K, 5] as of `_Difference`."""
    pairs = [evidence.probed_motions(offset) for offset in offsets.tolist()]
    rows, tried = np.concatenate(pairs), np.repeat(np.arange(len(pairs)), [len(each) for each in pairs])
    moving = np.hypot(rows[:, 3], rows[:, 4]) > _MOVING
    rows, tried = rows[moving], tried[moving]
    poses, wheels = rows[:, :3], rows[:, 3:]
    apart = poses - wheels
    differences = (
        np.hypot(apart[:, 0], apart[:, 1]),
        np.abs(apart[:, 0]),
        np.abs(wrapped(apart[:, 2])),
        np.hypot(wheels[:, 0], wheels[:, 1]),
        np.abs(wheels[:, 2]),
    )
    count = np.bincount(tried, minlength=len(pairs))
    ordered = np.full((len(differences), len(pairs), count.max()), np.nan)  # which is behind all numbers
    ordered[:, tried, np.arange(len(tried)) - (np.cumsum(count) - count)[tried]] = differences
    ordered.sort(axis=2)
    enough = np.flatnonzero(count >= _ENOUGH)
    count = count[enough]
    medians = 0.5 * (ordered[:, enough, (count - 1) // 2] + ordered[:, enough, count // 2])
    return offsets[enough], medians.T
