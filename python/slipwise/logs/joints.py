# SPDX-License-Identifier: Apache-2.0
"""Left and right wheel speeds out of joint states."""

from __future__ import annotations

import math
import re
from typing import Any

from slipwise.errors import LogError
from slipwise.logs.options import LogOptions

_LEFT = re.compile(r"left|(^|_)[frmb]?l($|_|\d|w)", re.IGNORECASE)
_RIGHT = re.compile(r"right|(^|_)[frmb]?r($|_|\d|w)", re.IGNORECASE)
_NOT_DRIVEN = re.compile(r"steer|caster|pan|tilt|arm|gripper|suspension|rocker", re.IGNORECASE)


class SideSpeeds:
    """Takes the mean speed of the left and of the right wheels [rad/s] from JointState messages."""

    def __init__(self, options: LogOptions) -> None:
        self._options = options
        self._names: tuple[str, ...] = ()
        self._sides: tuple[list[int], list[int]] = ([], [])

    def __call__(self, message: Any) -> tuple[float, float]:
        """Return (left, right); NaN where a message has no velocity for a side.

        Raises:
            LogError: the names of the joints do not tell the sides apart.
        """
        names = tuple(message.name)
        if names != self._names:
            self._names, self._sides = names, self._sorted(names)
        velocity = message.velocity
        if len(velocity) != len(names) or not all(self._sides):
            return (math.nan, math.nan)
        left, right = (sum(float(velocity[i]) for i in side) / len(side) for side in self._sides)
        return (left, right)

    def _sorted(self, names: tuple[str, ...]) -> tuple[list[int], list[int]]:
        if self._options.left_joints or self._options.right_joints:
            given = (self._options.left_joints, self._options.right_joints)
            return tuple([i for i, name in enumerate(names) if name in side] for side in given)  # type: ignore[return-value]
        wheels = [(i, name) for i, name in enumerate(names) if not _NOT_DRIVEN.search(name)]
        left = [i for i, name in wheels if _LEFT.search(name) and not _RIGHT.search(name)]
        right = [i for i, name in wheels if _RIGHT.search(name) and not _LEFT.search(name)]
        if not left or not right:
            shown = ", ".join(names[:12]) or "none"
            raise LogError(
                "cannot tell left from right wheels",
                advice=f"set left_joints and right_joints; joints: {shown}",
            )
        return left, right
