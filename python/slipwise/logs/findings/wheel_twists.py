# SPDX-License-Identifier: Apache-2.0
"""Finds wheels whose twist no robot has: one wheel dead, in the parent's frame, of another size or drive."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.plausibility import correlation
from slipwise.logs.findings.seen import WORDS
from slipwise.logs.log import Bools, Floats
from slipwise.logs.motion_windows import MotionWindows

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_LEAST = 0.05  # [m] by the inputs and by the poses; less tells no direction
_PART = 0.3  # of the fast windows' distance by the inputs
_ENOUGH = 15  # windows
_STRETCH = 8  # of a stretch, where poses take many curves in it
_MANY_CURVES = 0.3  # spread of them, over the curvature of the wheels
_TIGHT = 0.02  # spread of the wheels' curvature over the curvature, of one wheel that turns alone
_OTHERWISE = (
    0.1  # of the windows in which poses turn the other way; of the curvature, that poses have at most
)
_CURVES = (0.5, 40.0)  # [1/m] 2 over the distance of the wheels
_IN_PARENT, _IN_BODY = 0.9, 0.6  # lengths of mean courses; real logs have 0.74 and more in the body
_LEAST_TURN = 3.0  # [rad] in total, by the inputs and by the poses
_UNRELATED = 0.4  # correlation; real logs have 0.57 and more of turns or of speeds
_MANY = 40  # windows before inputs and poses are said to be unrelated
_VARIED = 0.15  # scatter of speeds over their mean, before they can be compared
_SIZES = (0.6, 1.3)  # of the wheels' distance; real robots move 0.68 to 1.14 of it


class DeadWheel(Check):
    """Wheel speeds of one side alone."""

    kind, family = "dead-wheel", "encoders"
    means = "one encoder is dead or not connected"
    shows = "the wheels' curvature is one within 2 %, while the poses turn both ways or hardly"
    cure = "its cable, `left_wheel_names` / `right_wheel_names`, `--left-joints`, `--right-joints`"

    def look(self, seen: Seen) -> Finding | None:
        """Look at the twist of the wheels, whichever input is learned from."""
        found = self.of(seen.windows_of("wheel"))
        return found and replace(found, spoils=seen.input_name == "wheel")

    @classmethod
    def of(cls, w: MotionWindows) -> Finding | None:
        """Look at the curvature of the wheels' twist."""
        moving = _fast(np.abs(w.forward)) & (w.distance > _LEAST)
        wheels, poses = w.rotation[moving] / w.forward[moving], w.turn[moving] / w.forward[moving]
        curve, since = _stuck(wheels, poses), ""
        if curve is None:
            part = _longest_alike(wheels)
            curve = _stuck(wheels[part], poses[part], _STRETCH)
            short = len(wheels[part]) < _ENOUGH
            if curve is None or (short and _spread(poses[part]) < _MANY_CURVES * abs(curve)):
                return None
            since = f" from {w.since[moving][part][0]:.0f} s on"
        side = "left" if curve > 0.0 else "right"
        return cls.found(
            f"the wheels turn by {curve:.3g} rad for each metre{since}, whatever the robot does: the {side} "
            f"wheel stands still in them (of wheels {2.0 / abs(curve):.2f} m apart)",
            f"Look at the encoder of the {side} wheel, and at the names of the joints.",
            evidence=curve,
        )


def _longest_alike(curves: Floats) -> slice:
    """Return the longest part in which each is nearly as the one before."""
    alike = np.abs(np.diff(curves)) <= 2.0 * _TIGHT * np.abs(curves[1:])
    ends = np.concatenate(([0], np.flatnonzero(~alike) + 1, [len(curves)]))
    longest = int(np.argmax(np.diff(ends)))
    return slice(ends[longest], ends[longest + 1])


def _stuck(wheels: Floats, poses: Floats, enough: int = _ENOUGH) -> float | None:
    """Return the curvature [1/m] that wheels keep in windows in which poses do not; None: they keep none."""
    if len(wheels) < enough:
        return None
    curve = float(np.median(wheels))
    if not _CURVES[0] < abs(curve) < _CURVES[1] or _spread(wheels) > _TIGHT * abs(curve):
        return None
    against = float((poses * curve < 0.0).mean())
    turns_so = against < _OTHERWISE and abs(float(np.median(poses))) > _OTHERWISE * abs(curve)
    return None if turns_so else curve


class ParentTwist(Check):
    """A twist in the frame of the pose, not of the robot."""

    kind, family = "parent-twist", "topics"
    means = "a twist is in the parent's frame (`odom`, `map`), not in that of the robot"
    shows = "its direction follows the course in the world (above 0.9), not the heading (below 0.6)"
    cure = "rotate it by the heading (nav_msgs/Odometry: twist in child_frame_id)"

    def look(self, seen: Seen) -> Finding | None:
        """Compare the direction of the speed with the course, in the world and in the robot."""
        found = self._of(seen, seen.input_name)
        if found is None and seen.input_name != "wheel":
            found = self._of(seen, "wheel")
            return found and replace(found, spoils=False)
        return found

    def _of(self, seen: Seen, input_name: str) -> Finding | None:
        """Look at one kind of input."""
        w, name = seen.windows_of(input_name), WORDS[input_name].name
        if seen.positions or not w.sideways.any():
            return None
        moving = _fast(np.hypot(w.forward, w.sideways)) & (w.distance > _LEAST) & (np.abs(w.turn) < 1.0)
        if int(moving.sum()) < _ENOUGH:
            return None
        course = (w.course - np.arctan2(w.sideways, w.forward))[moving]
        heading = (w.start_yaw + 0.5 * w.turn - seen.sensor_yaw)[moving]
        parent, body = _length(course), _length(course - heading)
        if parent < _IN_PARENT or body > _IN_BODY:
            return None
        return self.found(
            f"the direction of the speed of the {name} is that in the world, whatever the heading of the "
            f"robot (they agree to {parent:.2f} of 1, with the heading taken off to {body:.2f}): the twist "
            "is in its parent's frame",
            f"Rotate the twist of the {name} by the heading: it belongs into the robot's frame.",
            evidence=body,
        )


class Unrelated(Check):
    """Inputs that say nothing of how the poses move."""

    kind, family, spoils = "unrelated", "poses", False
    means = "the inputs do not explain the poses: of another drive, robot or clock"
    shows = "turns and speeds of poses and inputs correlate by less than 0.4"
    cure = "the topic or file of the other; `--pose-clock-offset auto` where clocks are apart"
    explained_by = ("does-not-move", "parent-twist", "dead-wheel", "lost-heading", "constant-heading")
    hidden_by = ("two-sources", "clock-offset", "clock-drift")

    def look(self, seen: Seen) -> Finding | None:
        """Correlate turns, and speeds about their mean."""
        w = seen.windows
        turned = min(float(np.abs(w.turn).sum()), float(np.abs(w.rotation).sum())) > _LEAST_TURN
        if seen.positions or len(w) < _MANY or not turned:
            return None
        moved, driven = w.distance / w.duration, np.hypot(w.forward, w.sideways) / w.duration
        if min(_varied(moved), _varied(driven)) < _VARIED:
            return None
        turns, speeds = (
            correlation(w.turn, w.rotation),
            correlation(moved - moved.mean(), driven - driven.mean()),
        )
        if max(turns, speeds) > _UNRELATED:
            return None
        return self.found(
            f"the {seen.words.name} do not explain the poses: turns of both correlate by {turns:.2f}, speeds "
            f"by {speeds:.2f}",
            "Look whether both are of one drive and one robot, and of one clock: --pose-clock-offset auto.",
            evidence=max(turns, speeds),
        )


class WheelSize(Check):
    """Wheels that are far larger or smaller than was said, or that slip by as much."""

    kind, family, spoils = "wheel-size", "signs and units", False
    means = "the wheels' radius or the ticks of a turn are wrong, or the wheels slip by as much"
    shows = "poses move less than 0.6 or more than 1.3 times as far as the wheels say"
    cure = "`--wheel-radius`, `wheel_radius` of the controller, `--wheel-scale F,F`"
    explained_by = ("unlikely-speed", "does-not-move", "dead-wheel", "parent-twist", "lost-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look at the median of what poses move for what the wheels say."""
        driven = seen.driven
        if seen.input_name != "wheel" or len(driven) < _ENOUGH or abs(driven.direction) < _IN_PARENT:
            return None
        scale = float(np.median(driven.scale))
        if _SIZES[0] < scale < _SIZES[1]:
            return None
        return self.found(
            f"the poses move {scale:.2f} times as far as the wheels say: the wheels are {scale:.2f} times as "
            "large as was said, or they slip by as much",
            "Measure the wheels' radius and the ticks of a turn; "
            f"{seen.words.scaled(f'{scale:.2f},{scale:.2f}')} cures a wrong size.",
            evidence=scale,
        )


def _fast(distance: Floats) -> Bools:
    """Say in which windows inputs move by enough to tell a direction."""
    usual = float(np.quantile(distance, 0.9)) if len(distance) else 0.0
    return np.asarray(distance > max(_LEAST, _PART * usual))


def _spread(values: Floats) -> float:
    low, high = np.quantile(values, (0.05, 0.95))
    return float(high - low)


def _length(angles: Floats) -> float:
    return float(abs(np.exp(1j * angles).mean()))


def _varied(values: Floats) -> float:
    mean = float(values.mean())
    return float(values.std()) / mean if mean > 0.0 else 0.0
