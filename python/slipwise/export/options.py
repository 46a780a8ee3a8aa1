# SPDX-License-Identifier: Apache-2.0
"""What an exported file depends on besides the model."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal

from slipwise.errors import SettingsError

NAV2_NAMES = ("rolling", "kilted")


@dataclass(frozen=True)
class ExportOptions:
    """Numbers of the robot and of its tools that a model does not hold.

    Raises:
        SettingsError: a number is not positive.
    """

    horizon: float = 1.0  # s; noise that lasts is spread over this time as if it were white
    wheel_separation: float | None = None  # m, nominal; needed to tell left from right wheels
    logged_separation_multiplier: float = 1.0  # in force while the log was recorded
    logged_radius_multiplier: float = 1.0  # in force while the log was recorded
    min_turning_radius: float | None = None  # m, by the geometry of an Ackermann vehicle
    nav2: Literal["rolling", "kilted"] = "rolling"  # whose parameter names MPPI gets

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, str) or value is None:
                continue
            if not (math.isfinite(value) and value > 0.0):
                raise SettingsError(
                    f"{field.name.replace('_', ' ')} must be positive, got {value:g}",
                    advice="leave it out, or give the robot's",
                )
        if self.nav2 not in NAV2_NAMES:
            raise SettingsError(
                f"unknown Nav2 version '{self.nav2}'", advice=f"one of {', '.join(NAV2_NAMES)}"
            )
