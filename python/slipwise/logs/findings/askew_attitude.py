# SPDX-License-Identifier: Apache-2.0
"""Finds a sensor of roll and pitch that leans on its robot: on no ground is every way uphill."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Poses

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_LEANS = 0.07  # rad; slopes make a drive shorter on the map, this one by a quarter of a per cent
_FAR = 10.0  # m that are driven
_AGAIN = 2.0  # times as long as the map is wide, so that the robot comes back to where it was
_ROUND = 0.5  # length of the mean of unit vectors ahead; 1 where all is driven in one direction
_STEP = 5.0  # m between poses; what is more is a jump
_EVEN = 0.5  # of the lean, scatter of the pitch about it
_CLIMBED = 0.5  # of the rise that the pitch claims, with which heights say that it is one
_UPRIGHT = 0.7  # cosine of a tilt; a sensor that leans further is found where logs are read


class AskewAttitude(Check):
    """A pitch that is the same whatever way the robot drives."""

    kind, family = "askew-attitude", "signs and units"
    means = "the sensor of roll and pitch is not mounted level: its lean passes for a slope"
    shows = "a mean pitch of 0.07 rad in all directions of a drive that comes back to where it was"
    cure = "correct the static transform from `base_link` to the sensor, or leave roll and pitch out"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at the pitch over the direction of the heading."""
        ways = [way for run in whole.log.runs if (way := _Way.of(run.poses)) is not None]
        if not ways:
            return None
        length = sum(way.length for way in ways)
        widest = max(way.width for way in ways)
        if length < max(_FAR, _AGAIN * widest):
            return None
        ahead, yaw, pitch, rise = np.concatenate([way.steps for way in ways]).T
        weight = np.abs(ahead)
        if np.abs(weight @ np.exp(1j * yaw)) > _ROUND * length:
            return None
        columns = np.column_stack((np.ones(len(yaw)), np.cos(yaw), np.sin(yaw)))
        root = np.sqrt(weight)
        found = np.linalg.lstsq(columns * root[:, None], pitch * root, rcond=None)[0]
        lean = float(found[0])
        scatter = float(np.sqrt(weight @ (pitch - columns @ found) ** 2 / length))
        if abs(lean) < _LEANS or scatter > _EVEN * abs(lean):
            return None
        claimed = -np.sin(lean) * float(ahead.sum())
        if np.isfinite(rise).all() and float(rise.sum()) / claimed > _CLIMBED:
            return None  # up a spiral
        off = 100.0 * (1.0 / np.cos(lean) - 1.0)
        return self.found(
            f"pitch is {np.degrees(lean):.0f} deg whatever way the robot drives, and comes back to where it "
            f"was: the sensor of roll and pitch leans, and ways are taken to be {off:.2g} % longer",
            "Correct the static transform from base_link to the sensor, or leave roll and pitch out.",
            evidence=lean,
        )


@dataclass(frozen=True, eq=False)
class _Way:
    """What a run drove with a pitch that was measured."""

    steps: Floats  # [N, 4] m ahead, heading and pitch [rad], m of rise (NaN: no height)
    length: float  # m
    width: float  # m, of the map that it was on

    @classmethod
    def of(cls, poses: Poses) -> _Way | None:
        """Return the way of poses; None where no pitch or no heading was measured."""
        if poses.roll is None or poses.pitch is None or poses.course or len(poses) < 2:
            return None
        x, y = np.diff(poses.x), np.diff(poses.y)
        yaw, pitch = poses.yaw[:-1], poses.pitch[:-1]
        upright = np.cos(poses.roll[:-1]) * np.cos(pitch) > _UPRIGHT  # false for NaN
        near = (np.diff(poses.frame) == 0) & (np.hypot(x, y) < _STEP) & upright
        if not near.any():
            return None
        ahead = x * np.cos(yaw) + y * np.sin(yaw)
        rise = np.full(len(x), np.nan) if poses.z is None else np.diff(poses.z)
        steps = np.column_stack((ahead, yaw, pitch, rise))[near]
        width = np.hypot(np.ptp(poses.x), np.ptp(poses.y))
        return cls(steps, float(np.abs(steps[:, 0]).sum()), float(width))
