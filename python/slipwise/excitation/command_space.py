# SPDX-License-Identifier: Apache-2.0
"""Which commands a robot may be given, and those over which its predictions are judged."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError

ROUNDING = 1e-9  # of a product that is to equal its limit


@dataclass(frozen=True)
class CommandSpace:
    """Limits of held commands, the same forwards and backwards, left and right.

    Raises:
        SettingsError: a limit is not positive, or speed or yaw rate is not finite.
    """

    speed: float  # m/s
    yaw_rate: float  # rad/s
    lateral: float = math.inf  # m/s^2, of speed times yaw rate

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            infinite = math.isinf(value) and field.name != "lateral"
            if not value > 0.0 or infinite:
                raise SettingsError(
                    f"the limit {field.name} is {value}", where=field.name, advice="give a positive number"
                )

    def slower(self, speed: float, yaw_rate: float) -> CommandSpace:
        """Return the same with these fractions of the limits."""
        return replace(self, speed=speed * self.speed, yaw_rate=yaw_rate * self.yaw_rate)

    def grid(self, levels: int) -> NDArray[np.float64]:
        """Return commands [N, 2] to both sides, `levels` of speed and yaw rate from zero to each limit."""
        return self._within(
            np.linspace(-self.speed, self.speed, 2 * levels - 1),
            np.linspace(-self.yaw_rate, self.yaw_rate, 2 * levels - 1),
        )

    def quadrant(self, levels: int) -> NDArray[np.float64]:
        """Return the grid's commands [N, 2] forwards and to the left, without standing still."""
        within = self._within(np.linspace(0.0, self.speed, levels), np.linspace(0.0, self.yaw_rate, levels))
        return within[np.any(within > 0.0, axis=1)]

    def _within(self, speeds: NDArray[np.float64], yaw_rates: NDArray[np.float64]) -> NDArray[np.float64]:
        v, omega = (axis.ravel() for axis in np.meshgrid(speeds, yaw_rates, indexing="ij"))
        kept = np.abs(v * omega) <= self.lateral * (1.0 + ROUNDING)
        return np.column_stack((v, omega))[kept]
