# SPDX-License-Identifier: Apache-2.0
"""What pushes a simulated vehicle beside its wheels: wind, a towed load; and a wheel that is stuck."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from slipwise.errors import SettingsError
from slipwise_sim.land_tamer import LandTamer, wheel_names

_LARGEST = 1e6  # N, N m


@dataclass(frozen=True)
class Push:
    """A steady force on the hull between two times.

    Raises:
        SettingsError: a number is not finite or beyond all forces, or the times are out of order.
    """

    force: tuple[float, float] = (0.0, 0.0)  # [N] along x and y
    moment: float = 0.0  # [N m] about the vertical, counter-clockwise
    frame: Literal["body", "world"] = "body"  # whose axes x and y are; wind does not turn with the robot
    start: float = 0.0  # [s]
    end: float = math.inf  # [s]

    def __post_init__(self) -> None:
        if not all(abs(number) <= _LARGEST for number in (*self.force, self.moment)):
            raise SettingsError("a push is beyond all forces", where="push", advice="give N and N m")
        if not self.start < self.end:
            raise SettingsError("a push ends before it starts", where="push", advice="swap start and end")

    def apply(self, data: Any, hull: int, t: float) -> None:
        """Write the push into MuJoCo's forces on the hull."""
        wrench = data.xfrc_applied[hull]
        if not self.start <= t < self.end:
            wrench[:] = 0.0
            return
        x, y = self.force
        if self.frame == "body":
            wrench[:3] = data.xmat[hull].reshape(3, 3) @ np.array([x, y, 0.0])
        else:
            wrench[:3] = x, y, 0.0
        wrench[3:] = 0.0, 0.0, self.moment


@dataclass(frozen=True)
class StuckWheel:
    """A wheel that is blocked from some time on and drags; the encoders of its side sit in the others.

    Raises:
        SettingsError: the vehicle has no such wheel.
    """

    wheel: str = "l1"  # l0, r0, l1, ...: side and axle, from the front
    start: float = 0.0  # [s]

    def column(self, vehicle: LandTamer) -> int:
        """Return the place of the wheel among the vehicle's."""
        names = wheel_names(vehicle)
        if self.wheel not in names:
            advice = "choose one of " + ", ".join(names)
            raise SettingsError(f"there is no wheel {self.wheel!r}", where="stuck", advice=advice)
        return names.index(self.wheel)
