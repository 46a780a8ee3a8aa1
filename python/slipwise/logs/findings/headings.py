# SPDX-License-Identifier: Apache-2.0
"""Finds headings and speeds that no slip explains: frames that are turned, flipped signs, other units."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.driven_windows import MOST_TURN, DrivenWindows
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.input_units import likely_commands, likely_speeds
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen

_ENOUGH = 6  # windows; with fewer nothing is said
_AGREE = 0.7  # length of a mean course from which on windows agree; the worst real log has 0.78
_AXES_DISAGREE = 0.4  # the same of axes: a robot that answers late goes against its inputs, along one axis
_TURNED = math.radians(30.0)  # a mean course further off than this is no slip; real logs have 8 degrees
_SQUARE = math.radians(20.0)  # a frame that is turned by so little more or less than a right angle
_SLOWEST = {"commands": 0.2, "wheels": 0.4}  # of the inputs' speed; spinning wheels lose less, limits more
_FASTEST = 3.0  # the same; nothing pushes a robot so fast
_SAME = 1.2  # times as fast at most, as commands and wheels that agree
_ENOUGH_OF_EACH = 20  # windows, slow and fast ones together
_LEAST = 0.05  # [m] by the commands, in a window
_ALIKE = 0.1  # of the speed: what slow and fast commands differ by at most, of a robot that answers late
_TURNS_MORE = 1.25  # times as much of the turns as of the speed: its yaw rate is in rad/s
_NO_TURN = 0.01  # of the inputs' turns
_ENOUGH_TURN = 3.0  # [rad] in total, by the inputs
_JUMP = 0.9  # mean length of the two courses before and after a jump
_LEAST_PART = 0.15  # of the windows, before and after a jump
_CERTAIN = 3.0  # standard errors of the angle between the two courses, beyond `_TURNED`


_ASKEW = math.radians(10.0)  # from here on a sideways way is said, which may be slip; real logs have 8
_ENOUGH_ASKEW = 20  # windows for that
_SURE = 5.0  # its standard deviations
_TOLD_APART = 0.1  # least singular value of ways and turns over the largest


class TurnedPoses(Check):
    """Poses that go elsewhere than the inputs say, all by the same angle."""

    kind, family = "turned-poses", "signs and units"
    means = "the heading of the poses is turned, such as by 90 degrees: a sensor's frame, or east for north"
    shows = "the mean course of the poses is off by more than 30 degrees; from 10 on, it may be side slip"
    cure = "`--pose-yaw-offset`, the sensor's static transform, or `--set sensor_extrinsics.yaw=...`"
    explained_by = ("does-not-move", "parent-twist", "course-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look at the mean course."""
        angle = _turned_by(seen)
        if angle is None:
            return self._askew(seen)
        if abs(angle) > math.pi - _TURNED:
            return None
        side = "left" if angle > 0.0 else "right"
        return self.found(
            f"the poses move to the {side} of their heading where the {seen.words.name} drive straight on: "
            f"their heading is turned by {_degrees(angle)} deg",
            f"Give {_yaw_offset(angle)}, which turns the heading of every pose [rad].",
            evidence=math.degrees(angle),
        )

    def _askew(self, seen: Seen) -> Finding | None:
        """Look for less, apart from what an arm of the sensor does in turns."""
        w = seen.windows
        if seen.positions or not _agree(seen.driven):
            return None
        near = (np.abs(w.turn) < MOST_TURN) & (np.abs(w.rotation) < MOST_TURN)
        way = (w.distance * np.exp(1j * w.course_ahead(seen.sensor_yaw)))[near]
        columns = np.column_stack((w.forward, w.turn, w.sideways))[near]
        sizes = np.sqrt(np.sum(columns**2, axis=0))
        columns = columns[:, sizes > 0.0] / sizes[sizes > 0.0]
        if len(way) < _ENOUGH_ASKEW or not sizes[0] > 0.0:
            return None
        values = np.linalg.svd(columns, compute_uv=False)
        solve = np.linalg.pinv(columns)
        straight = complex(solve[0] @ way)
        left = ((way - columns @ (solve @ way)) * np.conj(straight)).imag / abs(straight) ** 2
        angle, std = float(np.angle(straight)), float(np.linalg.norm(solve[0] * left))
        if values[-1] < _TOLD_APART * values[0] or abs(angle) < max(_ASKEW, _SURE * std):
            return None
        side = "left" if angle > 0.0 else "right"
        degrees = estimate_text(math.degrees(abs(angle)), math.degrees(std))
        yaw = round(seen.sensor_yaw - angle, 2) + 0.0  # no negative zero
        return self.found(
            f"the poses move {degrees} deg to the {side} of their heading where the {seen.words.name} drive "
            "straight on: a sensor that is turned on the robot would, or a robot that slips sideways so much",
            "If it is turned, or a --pose-yaw-offset in force is wrong, "
            f"--set sensor_extrinsics.yaw={yaw:.2f} says so: without it, speeds and wheel radii are learned "
            "too small.",
            evidence=math.degrees(angle),
            spoils=False,
        )


class BackwardPoses(Check):
    """Poses that go backwards where the inputs drive forwards."""

    kind, family = "backward-poses", "signs and units"
    means = "the heading is turned by 180 degrees, or the sign of the speed is flipped"
    shows = "the mean course of the poses is off by more than 150 degrees"
    cure = "`--pose-yaw-offset 3.1416`, `--wheel-scale -1,1` or `--command-scale -1,1`"
    explained_by = ("does-not-move", "parent-twist", "course-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look at the mean course; the other input tells a sign from a frame."""
        angle = _turned_by(seen)
        if angle is None or abs(angle) <= math.pi - _TURNED:
            return None
        words, alone = seen.words, seen.other_driven.direction.real > 0.5
        mostly_forward = float(np.sum(seen.driven.forward)) > 0.0
        ways = ("forwards", "backwards") if mostly_forward else ("backwards", "forwards")
        frame = f"If the pose sensor looks backwards, give {_yaw_offset(angle)} [rad]."
        sign = f"If the sign of {words.speed} is flipped, give {words.scaled('-1,1')}."
        by_sign = alone or not mostly_forward
        likely = "the sign of the speed is flipped" if by_sign else "the heading is turned by 180 deg"
        return self.found(
            f"the poses move {ways[1]} where the {words.name} drive {ways[0]}: probably {likely}",
            *((sign,) if alone else (frame, sign) if mostly_forward else (sign, frame)),
            evidence=math.degrees(angle),
        )


class UnlikelySpeed(Check):
    """Poses that follow the inputs, but so slowly or fast that the unit of speed is another."""

    kind, family = "unlikely-speed", "signs and units"
    means = "the speed is in rad/s, rpm, km/h or cm/s, or multiplied by a factor"
    shows = "poses move less than 0.2 (commands) or 0.4 (wheels) of it, or more than 3 times as far"
    cure = "`--command-scale V,OMEGA`, `--wheel-scale V,OMEGA` with the factor that is named"

    def look(self, seen: Seen) -> Finding | None:
        """Look at the median of what poses move for what the inputs say."""
        words, driven = seen.words, seen.driven
        if not _agree(driven):
            return None
        scale = float(np.median(driven.scale))
        if seen.input_name == "command" and _agree(seen.other_driven):
            by_wheels = float(np.median(seen.other_driven.scale))
            if abs(math.log(by_wheels / scale)) < math.log(_SAME):  # the wheels do as they are commanded
                words, scale = seen.other_words, by_wheels
        if _SLOWEST[words.name] <= scale <= _FASTEST:
            return None
        units = likely_speeds(scale)
        factor = (
            f"Convert it: {words.scaled(f'{scale:.2g},1')} multiplies it by about the factor of its unit "
            f"({scale:.2g},{scale:.2g} where the yaw rate is in that unit too)."
        )
        return self.found(
            f"the poses move {scale:.2g} times as far as the {words.name} say: {words.speed} is not in m/s"
            + (f", perhaps {units}" if units else ""),
            factor if scale < 1.0 else f"Check the units of poses, too. {factor}",
            evidence=scale,
        )


class OtherUnit(Check):
    """Commands of which the robot drives as little as if they were in km/h, at all speeds alike."""

    kind, family, spoils = "other-unit", "signs and units", False
    means = "commanded speeds are in km/h or miles per hour, or the drive has such a gain"
    shows = "poses move 0.26 to 0.29 or 0.41 to 0.46 of it, slow as fast; of turns a quarter more"
    cure = "`--command-scale 0.27778,1`, if they are"
    explained_by = ("unlikely-speed", "does-not-move", "lost-heading", "unrelated")

    def look(self, seen: Seen) -> Finding | None:
        """Compare slow with fast commands: a drive that is capped does less of fast ones."""
        if seen.input_name != "command" or seen.commanded.throttle or not _agree(seen.driven):
            return None
        turns, w = seen.agreement(seen.input_name), seen.windows
        asked = np.hypot(w.forward, w.sideways)
        along = (asked > _LEAST) & (np.abs(w.rotation) < MOST_TURN) & (np.abs(w.turn) < MOST_TURN)
        if along.sum() < _ENOUGH_OF_EACH:
            return None
        asked, done = asked[along], w.distance[along] / asked[along]
        slow = asked <= np.median(asked)
        if slow.all():  # one speed alone
            return None
        scale, *halves = (float(np.median(part)) for part in (done, done[slow], done[~slow]))
        unit = likely_commands(scale)
        alike = all(abs(half / scale - 1.0) < _ALIKE for half in halves)
        well_turned = turns.turning > _ENOUGH_TURN and turns.yaw_ratio > _TURNS_MORE * scale
        if unit is None or not alike or not well_turned:
            return None
        name, factor = unit
        return self.found(
            f"the robot drives {100.0 * scale:.0f} % of what it is commanded, slowly as fast, and turns "
            f"{100.0 * turns.yaw_ratio:.0f} %: the commanded speed is in {name} ({100.0 * factor:.0f} % of "
            "m/s), or the drive has such a gain",
            f"If it is in {name}, {seen.words.scaled(f'{factor:.5g},1')} converts it.",
            evidence=scale,
        )


class ConstantHeading(Check):
    """A heading that never changes."""

    kind, family = "constant-heading", "poses"
    means = "the heading never changes: a source without one, or a column that was not filled"
    shows = "poses turn less than 1 % of what the inputs turn, by 3 rad and more"
    cure = "another source of poses, or the column `yaw`"
    explained_by = ("does-not-move", "parent-twist", "course-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look at the turns of the poses."""
        windows, driven = seen.windows, seen.driven
        if seen.positions or len(driven) < _ENOUGH:
            return None
        turned, commanded = float(np.abs(windows.turn).sum()), float(np.abs(windows.rotation).sum())
        if abs(driven.direction) >= _AGREE or commanded <= _ENOUGH_TURN or turned >= _NO_TURN * commanded:
            return None
        return self.found(
            f"the heading of the poses never changes, though the {seen.words.name} turn by "
            f"{commanded:.3g} rad and the course of the poses changes",
            "Record a source of poses with a heading, or fill the column yaw.",
            evidence=commanded,
        )


class HeadingJump(Check):
    """A heading that jumps against the course at one time."""

    kind, family = "heading-jump", "poses"
    means = "the heading jumps once, such as when a compass or a localiser finds itself again"
    shows = "courses before and after differ by more than 30 degrees, each with itself by far less"
    cure = "`--end` and `--start`: learn from before and after as two logs"
    explained_by = ("does-not-move", "parent-twist", "course-heading", "constant-heading")

    def look(self, seen: Seen) -> Finding | None:
        """Look for the time at which two mean courses differ most."""
        return None if seen.positions or len(seen.driven) < _ENOUGH else self._jump(seen.driven)

    def _jump(self, driven: DrivenWindows) -> Finding | None:
        count = len(driven)
        before = np.cumsum(driven.course)
        lengths = np.abs(before) + np.abs(before[-1] - before)
        least = max(3, round(_LEAST_PART * count))
        if 2 * least > count:
            return None
        k = least - 1 + int(np.argmax(lengths[least - 1 : count - least]))
        angle = float(np.angle((before[-1] - before[k]) * np.conj(before[k])))
        least_angle = _TURNED + _CERTAIN * _error(lengths[k] / count, k + 1, count)
        if lengths[k] < _JUMP * count or abs(angle) < least_angle:
            return None
        return self.found(
            f"the heading of the poses jumps by {_degrees(angle)} deg against their course, between "
            f"t = {driven.start[k]:.1f} s and {driven.start[k + 1]:.1f} s",
            "Check the source of the heading, and learn from before and after it as two logs.",
            evidence=math.degrees(angle),
        )


class LostHeading(Check):
    """A heading that does not go with the course."""

    kind, family = "lost-heading", "poses"
    means = "the heading does not go with the course: random, or of a localiser that is lost"
    shows = "courses agree with headings along no axis (mean length below 0.4)"
    cure = "another source of the heading, or positions alone (`--set live.positions=true`)"
    explained_by = ("does-not-move", "parent-twist", "course-heading", "constant-heading", "heading-jump")

    def look(self, seen: Seen) -> Finding | None:
        """Look at the axes along which poses move."""
        driven = seen.driven
        if seen.positions or len(driven) < _ENOUGH or _agree(driven):
            return None
        length = abs(complex((driven.course**2).mean()))
        if length >= _AXES_DISAGREE:
            return None
        return self.found(
            "the heading of the poses does not go with the course that they take",
            "Check where the heading comes from: a localiser that is lost has none.",
            evidence=length,
        )


def _turned_by(seen: Seen) -> float | None:
    """By which angle poses go elsewhere than the inputs say [rad]; None where that may be slip."""
    angle = math.atan2(seen.driven.direction.imag, seen.driven.direction.real)
    if seen.positions or not _agree(seen.driven) or abs(angle) < _TURNED:
        return None
    return angle


def _error(length: float, before: int, count: int) -> float:
    """Return the standard error of the angle between two mean courses [rad].

    One is of the windows `before`, the other of the rest; they scatter so that means are of this length.
    """
    scatter = math.sqrt(-2.0 * math.log(min(length, 1.0)))
    return scatter * math.sqrt(1.0 / before + 1.0 / (count - before))


def _agree(driven: DrivenWindows) -> bool:
    return len(driven) >= _ENOUGH and abs(driven.direction) > _AGREE


def _yaw_offset(angle: float) -> str:
    return f"--pose-yaw-offset {_offset(angle):.4f} (plus one in force)"


def _offset(angle: float) -> float:
    """The angle, or the right angle that it is meant to be."""
    square = round(angle / (0.5 * math.pi)) * 0.5 * math.pi
    return square if abs(angle - square) < _SQUARE else angle


def _degrees(angle: float) -> str:
    return f"{abs(math.degrees(_offset(angle))):.0f}"
