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

_LEANS = 0.07  # rad; ways on a slope are shorter on the map, on this one by a quarter of a per cent
_FAR = 10.0  # m that are driven
_AGAIN = 2.0  # times as long as the map is wide, so that the robot comes back to where it was
_ROUND = 0.5  # length of the mean of unit vectors ahead; 1 where all is driven in one direction
_STEP = 5.0  # m between poses; what is more is a jump
_EVEN = 0.5  # of the lean, scatter of the pitch about it
_CLIMBED = 0.5  # of the rise that the pitch claims, with which heights say that it is one
_TURNED = 3.0  # rad to either side; who always turns to one side may drive on banked ground
_SPACED = 1.0  # s between headings, so that their noise turns nothing
_UPRIGHT = 0.7  # cosine of a tilt; a sensor that leans further is found where logs are read


class AskewAttitude(Check):
    """A pitch or a roll that is the same whatever way the robot drives."""

    kind, family = "askew-attitude", "signs and units"
    means = "the sensor of roll and pitch is not mounted level: its lean passes for a slope"
    shows = "a mean pitch or roll of 0.07 rad in all directions of a drive that comes back"
    cure = "correct the static transform from `base_link` to the sensor, or leave roll and pitch out"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at pitch and roll over the direction of the heading."""
        ways = [way for run in whole.log.runs if (way := _Way.of(run.poses)) is not None]
        if not ways:
            return None
        length = sum(way.length for way in ways)
        widest = max(way.width for way in ways)
        if length < max(_FAR, _AGAIN * widest):
            return None
        ahead, yaw, pitch, roll, rise = np.concatenate([way.steps for way in ways]).T
        weight = np.abs(ahead)
        if np.abs(weight @ np.exp(1j * yaw)) > _ROUND * length:
            return None
        lean = _lean(pitch, yaw, weight)
        claimed = -np.sin(lean) * float(ahead.sum())
        if lean and not (np.isfinite(rise).all() and float(rise.sum()) / claimed > _CLIMBED):
            return self._leans("pitch", lean)
        lean = _lean(roll, yaw, weight)
        if lean and min(sum(way.left for way in ways), sum(way.right for way in ways)) > _TURNED:
            return self._leans("roll", lean)
        return None

    def _leans(self, angle: str, lean: float) -> Finding:
        return self.found(
            f"{angle} is {np.degrees(lean):.0f} deg whatever way the robot drives, and comes back to where "
            "it was: the sensor of roll and pitch leans, and what is learned takes that for a slope",
            "Correct the static transform from base_link to the sensor, or leave roll and pitch out.",
            evidence=lean,
        )


def _lean(angle: Floats, yaw: Floats, weight: Floats) -> float:
    """Return the part of an angle [rad] that no plane explains; 0 where it is small, or scatters."""
    columns = np.column_stack((np.ones(len(yaw)), np.cos(yaw), np.sin(yaw)))
    root = np.sqrt(weight)
    found = np.linalg.lstsq(columns * root[:, None], angle * root, rcond=None)[0]
    lean = float(found[0])
    scatter = float(np.sqrt(weight @ (angle - columns @ found) ** 2 / weight.sum()))
    return 0.0 if abs(lean) < _LEANS or scatter > _EVEN * abs(lean) else lean


@dataclass(frozen=True, eq=False)
class _Way:
    """What a run drove while roll and pitch were measured."""

    steps: Floats  # [N, 5] m ahead, heading, pitch and roll [rad], m of rise (NaN: no height)
    length: float  # m
    width: float  # m, of the map that it was on
    left: float  # rad turned to the left,
    right: float  # and to the right

    @classmethod
    def of(cls, poses: Poses) -> _Way | None:
        """Return the way of poses; None where no attitude or no heading was measured."""
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
        steps = np.column_stack((ahead, yaw, pitch, poses.roll[:-1], rise))[near]
        width = np.hypot(np.ptp(poses.x), np.ptp(poses.y))
        spaced = np.unique(np.floor((poses.t - poses.t[0]) / _SPACED), return_index=True)[1]
        turned = np.diff(np.unwrap(poses.yaw[spaced]))
        left, right = float(turned[turned > 0.0].sum()), -float(turned[turned < 0.0].sum())
        return cls(steps, float(np.abs(steps[:, 0]).sum()), float(width), left, right)
