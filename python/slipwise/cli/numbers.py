# SPDX-License-Identifier: Apache-2.0
"""Several numbers in one option, such as a pose, an area or a grade."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from slipwise.errors import SettingsError

if TYPE_CHECKING:
    from slipwise.ground import Grade


_TURN = 6.2832  # rad, 2 pi as it is typed


def _numbers(text: str, option: str, names: str, example: str) -> tuple[float, ...]:
    """Return the numbers of `text` in the order of `names`, which begins with what they are.

    Raises:
        SettingsError: there are more or less of them, or one is no finite number.
    """
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    what, order = names.split()
    if len(numbers) != len(order.split(",")) or not all(map(math.isfinite, numbers)):
        raise SettingsError(
            f"{text!r} is not a {what}", where=option, advice=f"give {order}, such as {example}"
        )
    return numbers


def pose_of(text: str, option: str) -> tuple[float, float, float]:
    """Return a pose (x, y [m], yaw [rad]).

    Raises:
        SettingsError: it is none, or its heading is more than a turn, as headings in degrees are.
    """
    x, y, yaw = _numbers(text, option, "pose X,Y,YAW", "1.5,2,0.3")
    if abs(yaw) > _TURN:
        raise SettingsError(
            f"a heading of {yaw:.10g} rad is more than a turn",
            where=option,
            advice=f"give radians: {yaw:.10g} degrees are {math.radians(yaw):.4g}",
        )
    return x, y, yaw


def area_of(text: str, option: str) -> tuple[float, float]:
    """Return width and depth [m] of an area such as 8x8.

    Raises:
        SettingsError: it is none.
    """
    try:
        width, depth = (float(side) for side in text.lower().split("x"))
    except ValueError:
        raise SettingsError(
            f"{text!r} is not an area", where=option, advice="such as 8x8, in metres"
        ) from None
    return width, depth


def grade_of(text: str | None) -> Grade | None:
    """Return the ground of `--grade`: slope and direction in which it falls, in degrees; level without one.

    Raises:
        SettingsError: it is none.
    """
    from slipwise.ground import Grade

    if text is None:
        return None
    slope, downhill = _numbers(text, "--grade", "grade SLOPE,DOWNHILL", "8,-90")
    return Grade(math.radians(slope), math.radians(downhill))
