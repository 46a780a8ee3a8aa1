# SPDX-License-Identifier: Apache-2.0
"""Finds poses that were interpolated: a path that is dead straight from a corner to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.log import Bools, Floats, Poses
from slipwise.logs.motion_windows import wrapped

_MOVED = 0.2  # of a long step; of shorter ones rounding makes the course
_STEPS = (0.5, 1.5)  # of the usual time between poses; farther off, something is missing
_SHARP = 6.0  # times the usual bend from a step to the next, and more than the mean square, is a corner
_CORNERS = 15  # a log has,
_BENT = 0.7  # part of the squares of all bends that is in them,
_HARMLESS = 0.3  # [s] between corners; of 0.5 s, turns are off by four standard deviations
_EVENLY = (0.6, 0.15, 0.85)  # least of their usual distance, how far from whole multiples of it, and how many
_FEWEST = 3  # poses from a corner to the next
_FOLLOWED = 0.2  # of what the heading turns between corners, the path bends; by any drive it would be all
_TURNED = 0.02  # of what the path bends in corners, the heading turns between them at least


class FilledPoses(Check):
    """Poses that someone put on straight lines between the few that were measured."""

    kind, family, reserves = "filled-poses", "poses", True
    means = "poses were interpolated to a higher rate: the path is straight where the robot turned"
    shows = (
        "the path has 15 evenly spaced corners, dead straight in between, where the heading turns; "
        "no model is good where they are 0.3 s apart"
    )
    cure = "give the poses as they were measured, or set `pose_new` to 0 in rows between the corners"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at the bends of the path of each run, until one was filled."""
        for run in whole.log.runs:
            found = _Bends.of(run.poses.as_measured).filled()
            if found is not None:
                count, seconds = found
                return self.found(
                    f"poses were interpolated: their path has a corner every {seconds:.2g} s and is dead "
                    f"straight in between: one of {count} was measured, and the robot turned at other times",
                    "Give the poses as they were measured, or set pose_new to 0 in rows between the corners.",
                    evidence=float(count),
                    spoils=seconds > _HARMLESS,
                )
        return None


@dataclass(frozen=True, eq=False)
class _Bends:
    """What a path does at N of its poses, from the step before to the step after."""

    at: Floats  # [N] number of the pose
    t: Floats  # [N] s
    bend: Floats  # [N] rad, of the path
    turn: Floats  # [N] rad, of the heading, by half of both steps; NaN where none was measured

    @classmethod
    def of(cls, poses: Poses) -> _Bends:
        """Take the poses at which the robot goes on moving."""
        if len(poses) < 3:
            return cls(*np.empty((4, 0)))
        dx, dy, dt = np.diff(poses.x), np.diff(poses.y), np.diff(poses.t)
        step, usual = np.hypot(dx, dy), float(np.median(dt))
        whole = (dt > _STEPS[0] * usual) & (dt < _STEPS[1] * usual) & (np.diff(poses.frame) == 0)
        whole &= step > _MOVED * np.quantile(step, 0.9)
        at = np.flatnonzero(whole[1:] & whole[:-1]) + 1
        bend = wrapped(np.diff(np.arctan2(dy, dx)))[at - 1]
        yaw = np.full(len(poses), np.nan) if poses.course else np.unwrap(poses.yaw)
        return cls(at.astype(np.float64), poses.t[at], bend, 0.5 * (yaw[at + 1] - yaw[at - 1]))

    def filled(self) -> tuple[int, float] | None:
        """Return how many poses there are from a corner to the next, and s; None where none were filled."""
        if len(self.at) < _CORNERS * _FEWEST:
            return None
        size = np.abs(self.bend)
        corner = size > max(_SHARP * float(np.median(size)), float(np.sqrt(np.mean(size**2))), 1e-6)
        gaps, seconds = np.diff(self.at[corner]), np.diff(self.t[corner])
        if len(gaps) < _CORNERS or (size[corner] ** 2).sum() < _BENT * (size**2).sum():
            return None
        usual = float(np.median(gaps))
        if usual < _FEWEST or not _evenly(gaps / usual) or not self._straight_between(corner):
            return None
        return round(usual), float(np.median(seconds))

    def _straight_between(self, corner: Bools) -> bool:
        """Whether the path does not follow the heading between corners; where none was measured, it is so."""
        if np.isnan(self.turn).any():
            return True
        turn, bend = self.turn[~corner], self.bend[~corner]
        turned = float(np.abs(turn).sum()) > _TURNED * float(np.abs(self.bend[corner]).sum())
        return turned and abs(float(bend @ turn)) < _FOLLOWED * float(turn @ turn)


def _evenly(gaps: Floats) -> bool:
    """Whether corners come by a clock; gaps in units of the usual one."""
    least, off, most = _EVENLY
    return float(np.mean((gaps > least) & (np.abs(gaps - np.round(gaps)) <= off))) >= most
