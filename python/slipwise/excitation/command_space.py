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
    sideways: float = 0.0  # m/s to both sides; 0: the robot does not drive sideways
    curvature: float = math.inf  # 1/m, of yaw rate over speed; a robot that steers has a largest

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            infinite = math.isinf(value) and field.name not in ("lateral", "curvature")
            if not (value > 0.0 or (value == 0.0 and field.name == "sideways")) or infinite:
                raise SettingsError(
                    f"the limit {field.name} is {value}", where=field.name, advice="give a positive number"
                )

    def slower(self, speed: float, yaw_rate: float) -> CommandSpace:
        """Return the same with these fractions of the limits."""
        sideways = speed * self.sideways
        return replace(self, speed=speed * self.speed, yaw_rate=yaw_rate * self.yaw_rate, sideways=sideways)

    def grid(self, levels: int) -> NDArray[np.float64]:
        """Return commands (v, vy, omega) [N, 3] to both sides.

        `levels` of speed and yaw rate from zero to each limit; sideways, the limits alone.
        """
        speeds = np.linspace(-self.speed, self.speed, 2 * levels - 1)
        yaw_rates = np.linspace(-self.yaw_rate, self.yaw_rate, 2 * levels - 1)
        return self._within(speeds, yaw_rates, (-1.0, 0.0, 1.0))

    def quadrant(self, levels: int) -> NDArray[np.float64]:
        """Return the grid's commands (v, vy, omega) [N, 3] forwards and to the left, without standing."""
        speeds, yaw_rates = np.linspace(0.0, self.speed, levels), np.linspace(0.0, self.yaw_rate, levels)
        within = self._within(speeds, yaw_rates, (0.0, 0.5, 1.0))
        return within[np.any(within > 0.0, axis=1)]

    def _within(
        self, speeds: NDArray[np.float64], yaw_rates: NDArray[np.float64], aside: tuple[float, ...]
    ) -> NDArray[np.float64]:
        """Return all pairs of speeds and yaw rates; sideways, with the first, middle and last of each."""
        rows: list[NDArray[np.float64]] = []
        for vy in (part * self.sideways for part in aside):
            if vy == 0.0 and rows and not rows[-1][:, 1].any():
                continue  # the robot does not drive sideways
            few = slice(None) if vy == 0.0 else [0, len(speeds) // 2, -1]
            v, omega = (axis.ravel() for axis in np.meshgrid(speeds[few], yaw_rates[few], indexing="ij"))
            rows.append(np.column_stack((v, np.full(len(v), vy), omega)))
        all_rows = np.vstack(rows)
        driven, turned = np.hypot(all_rows[:, 0], all_rows[:, 1]), np.abs(all_rows[:, 2])
        within = driven * turned <= self.lateral * (1.0 + ROUNDING)
        if math.isfinite(self.curvature):
            within &= turned <= self.curvature * driven * (1.0 + ROUNDING)
        kept: NDArray[np.float64] = all_rows[within]
        return kept
