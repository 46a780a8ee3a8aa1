# SPDX-License-Identifier: Apache-2.0
"""Left and right wheel speeds out of joint states."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.log import Bools, Floats
from slipwise.logs.options import LogOptions

_LEFT = re.compile(r"left|(^|_)[frmb]?l($|_|\d|w)", re.IGNORECASE)
_RIGHT = re.compile(r"right|(^|_)[frmb]?r($|_|\d|w)", re.IGNORECASE)
_NOT_DRIVEN = re.compile(r"steer|caster|pan|tilt|arm|gripper|suspension|rocker", re.IGNORECASE)

_WHOLE_TURN = 2.0 * math.pi


class SideMotion:
    """Takes the mean speed [rad/s] and angle [rad] of the left and of the right wheels from joint states.

    Angles that jump by about a whole turn, from a joint that is kept within one, are followed on. A message
    without wheels of both sides, such as that of an arm, gives no numbers.
    """

    def __init__(self, options: LogOptions) -> None:
        self._options = options
        self._sides: dict[tuple[str, ...], tuple[list[int], list[int]] | None] = {}  # by the joints' names
        self._angles: dict[str, tuple[float, float]] = {}  # of each joint: as measured, and followed on

    def __call__(self, message: Any) -> tuple[float, float, float, float]:
        """Return speeds (left, right) and angles (left, right); NaN where a message has none for a side."""
        names = tuple(message.name)
        sides = self._of(names)
        if sides is None:
            return (math.nan, math.nan, math.nan, math.nan)
        angles = message.position
        followed = [self._follow(name, float(a)) for name, a in zip(names, angles, strict=False)]
        return (*_means(names, sides, message.velocity), *_means(names, sides, followed))

    def refuse_none(self) -> None:
        """Raise LogError where no message that came had wheels of both sides."""
        if self._sides and not any(self._sides.values()):
            sides_of(tuple(dict.fromkeys(name for names in self._sides for name in names)), self._options)
            raise LogError(
                "no message has joints of left and right wheels",
                advice="give --left-joints and --right-joints of one publisher, or record it alone",
            )

    def check(self, message: Any) -> None:
        """Raise LogError where a message has no wheels of both sides."""
        names = tuple(message.name)
        if self._of(names) is None:
            raise LogError("a message has no joints of left and right wheels", advice=", ".join(names[:12]))

    def _of(self, names: tuple[str, ...]) -> tuple[list[int], list[int]] | None:
        if names not in self._sides:
            try:
                found = sides_of(names, self._options)
            except LogError:
                self._sides[names] = None
            else:
                self._sides[names] = found if all(found) else None
        return self._sides[names]

    def _follow(self, name: str, angle: float) -> float:
        measured, followed = self._angles.get(name, (angle, angle))
        step = angle - measured
        if math.pi < abs(step) <= _WHOLE_TURN and max(abs(angle), abs(measured)) <= _WHOLE_TURN:
            step -= math.copysign(_WHOLE_TURN, step)
        if math.isfinite(step):
            self._angles[name] = (angle, followed + step)
            return followed + step
        return math.nan


def _means(names: tuple[str, ...], sides: tuple[list[int], list[int]], values: Any) -> tuple[float, float]:
    if len(values) != len(names):
        return (math.nan, math.nan)
    left, right = (sum(float(values[i]) for i in side) / len(side) for side in sides)
    return (left, right)


def sides_of(names: tuple[str, ...], options: LogOptions) -> tuple[list[int], list[int]]:
    """Return which joints are wheels of the left and of the right side, given or by their names.

    Raises:
        LogError: the names do not tell the sides apart.
    """
    if options.left_joints or options.right_joints:
        given = (options.left_joints, options.right_joints)
        left, right = ([i for i, name in enumerate(names) if name in side] for side in given)
        return left, right
    wheels = [(i, name) for i, name in enumerate(names) if not _NOT_DRIVEN.search(name)]
    left = [i for i, name in wheels if _LEFT.search(name) and not _RIGHT.search(name)]
    right = [i for i, name in wheels if _RIGHT.search(name) and not _LEFT.search(name)]
    if not left or not right:
        shown = ", ".join(names[:12]) or "none"
        raise LogError(
            "cannot tell left from right wheels",
            advice=f"give --left-joints and --right-joints; joints: {shown}",
        )
    return left, right


def sides_text(names: tuple[str, ...], options: LogOptions) -> str:
    """Say which joints look like wheels of which side, or what to give where the names do not tell."""
    try:
        sides = sides_of(names, options)
    except LogError as unclear:
        return f"{unclear.what}: {unclear.advice}"
    left, right = (", ".join(names[i] for i in side[:4]) for side in sides)
    return f"left: {left or 'none'}; right: {right or 'none'}"


def speeds_from_angles(t: Floats, angles: Floats) -> Floats:
    """Return the speeds [N, K] that take each angle [N, K] to the next one, held from each stamp [N] on.

    NaN where stamps do not go forward; the last sample keeps the speed before it.
    """
    steps = np.diff(t)
    forward: Bools = steps > 0.0
    speeds = np.full_like(angles, np.nan)
    speeds[:-1][forward] = np.diff(angles, axis=0)[forward] / steps[forward, None]
    speeds[-1:] = speeds[-2:-1]
    return speeds
