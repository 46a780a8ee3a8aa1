# SPDX-License-Identifier: Apache-2.0
"""Finds headings and speeds that no slip explains: frames that are turned, flipped signs, other units."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from slipwise.logs.contradiction import Contradiction
from slipwise.logs.driven_windows import DrivenWindows
from slipwise.logs.input_units import likely_speeds
from slipwise.logs.motion_windows import MotionWindows

_ENOUGH = 6  # windows; with fewer nothing is said
_AGREE = 0.7  # length of a mean course from which on windows agree; the worst real log has 0.78
_AXES_DISAGREE = 0.4  # the same of axes: a robot that answers late goes against its inputs, along one axis
_TURNED = math.radians(30.0)  # a mean course further off than this is no slip; real logs have 8 degrees
_SQUARE = math.radians(20.0)  # a frame that is turned by so little more or less than a right angle
_SLOWEST = {"commands": 0.2, "wheels": 0.4}  # of the inputs' speed; spinning wheels lose less, limits more
_FASTEST = 3.0  # the same; nothing pushes a robot so fast
_NO_TURN = 0.01  # of the inputs' turns
_ENOUGH_TURN = 3.0  # [rad] in total, by the inputs
_JUMP = 0.9  # mean length of the two courses before and after a jump
_LEAST_PART = 0.15  # of the windows, before and after a jump
_CERTAIN = 3.0  # standard errors of the angle between the two courses, beyond `_TURNED`


@dataclass(frozen=True)
class InputWords:
    """How one kind of input is called."""

    name: str  # "commands" or "wheels"
    speed: str  # its speed
    option: str  # that scales it


COMMANDS = InputWords("commands", "the commanded speed", "--command-scale")
WHEELS = InputWords("wheels", "the speed of the wheels", "--wheel-scale")


def turned_heading(driven: DrivenWindows, words: InputWords, *, alone: bool) -> Contradiction | None:
    """Say whether poses go elsewhere than the inputs say, all by the same angle.

    Args:
        driven: of one kind of input.
        words: of that input.
        alone: the other kind of input agrees with the poses, so that this one is wrong.
    """
    angle = math.atan2(driven.direction.imag, driven.direction.real)
    if not _agree(driven) or abs(angle) < _TURNED:
        return None
    if abs(angle) > math.pi - _TURNED:
        return _backwards(driven, words, angle, alone=alone)
    side = "left" if angle > 0.0 else "right"
    return Contradiction(
        "turned-poses",
        f"the poses move to the {side} of their heading where the {words.name} drive straight on: their "
        f"heading is turned by {_degrees(angle)} deg",
        (f"Give --pose-yaw-offset {_offset(angle):.4f}, which turns the heading of every pose [rad].",),
    )


def _backwards(driven: DrivenWindows, words: InputWords, angle: float, *, alone: bool) -> Contradiction:
    mostly_forward = float(np.sum(driven.forward)) > 0.0
    ways = ("forwards", "backwards") if mostly_forward else ("backwards", "forwards")
    frame = f"If the pose sensor looks backwards, give --pose-yaw-offset {_offset(angle):.4f} [rad]."
    sign = f"If the sign of {words.speed} is flipped, give {words.option} -1,1."
    likely = "the sign of the speed is flipped" if alone or not mostly_forward else "the heading is turned"
    return Contradiction(
        "backward-poses",
        f"the poses move {ways[1]} where the {words.name} drive {ways[0]}: probably {likely}"
        + ("" if "sign" in likely else " by 180 deg"),
        (sign,) if alone else (frame, sign) if mostly_forward else (sign, frame),
    )


def unlikely_speed(driven: DrivenWindows, words: InputWords) -> Contradiction | None:
    """Say whether poses follow the inputs, but so slowly or fast that the unit of speed is another."""
    if not _agree(driven):
        return None
    scale = float(np.median(driven.scale))
    if _SLOWEST[words.name] <= scale <= _FASTEST:
        return None
    units = likely_speeds(scale)
    factor = (
        f"Convert it: {words.option} {scale:.2g},1 multiplies it by about the factor of its unit "
        f"({scale:.2g},{scale:.2g} where the yaw rate is in that unit too)."
    )
    return Contradiction(
        "unlikely-speed",
        f"the poses move {scale:.2g} times as far as the {words.name} say: {words.speed} is not in m/s"
        + (f", perhaps {units}" if units else ""),
        (factor if scale < 1.0 else f"Check the units of poses, too. {factor}",),
    )


def lost_heading(windows: MotionWindows, driven: DrivenWindows, words: InputWords) -> Contradiction | None:
    """Say whether the heading of the poses does not go with their course: constant, jumping or random."""
    if len(driven) < _ENOUGH:
        return None
    turned, commanded = float(np.abs(windows.turn).sum()), float(np.abs(windows.rotation).sum())
    if abs(driven.direction) < _AGREE and commanded > _ENOUGH_TURN and turned < _NO_TURN * commanded:
        return Contradiction(
            "constant-heading",
            f"the heading of the poses never changes, though the {words.name} turn by {commanded:.3g} rad "
            "and the course of the poses changes",
            ("Record a source of poses with a heading, or fill the column yaw.",),
        )
    jump = _jump(driven)
    if jump is not None:
        return jump
    if not _agree(driven) and abs(complex((driven.course**2).mean())) < _AXES_DISAGREE:
        return Contradiction(
            "lost-heading",
            "the heading of the poses does not go with the course that they take",
            ("Check where the heading comes from: a localiser that is lost has none.",),
        )
    return None


def _jump(driven: DrivenWindows) -> Contradiction | None:
    """Find one time at which the heading jumps against the course."""
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
    return Contradiction(
        "heading-jump",
        f"the heading of the poses jumps by {_degrees(angle)} deg against their course, between "
        f"t = {driven.start[k]:.1f} s and {driven.start[k + 1]:.1f} s",
        ("Check the source of the heading, and learn from before and after it as two logs.",),
    )


def _error(length: float, before: int, count: int) -> float:
    """Return the standard error of the angle between two mean courses [rad].

    One is of the windows `before`, the other of the rest; they scatter so that means are of this length.
    """
    scatter = math.sqrt(-2.0 * math.log(min(length, 1.0)))
    return scatter * math.sqrt(1.0 / before + 1.0 / (count - before))


def _agree(driven: DrivenWindows) -> bool:
    return len(driven) >= _ENOUGH and abs(driven.direction) > _AGREE


def _offset(angle: float) -> float:
    """The angle, or the right angle that it is meant to be."""
    square = round(angle / (0.5 * math.pi)) * 0.5 * math.pi
    return square if abs(angle - square) < _SQUARE else angle


def _degrees(angle: float) -> str:
    return f"{abs(math.degrees(_offset(angle))):.0f}"
