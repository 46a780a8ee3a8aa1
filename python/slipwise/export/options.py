# SPDX-License-Identifier: Apache-2.0
"""What an exported file depends on besides the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from slipwise.errors import SettingsError

NAV2_NAMES = ("rolling", "kilted")

#: What makes sense of each number; far outside of these it has another unit.
_BOUNDS = {
    "horizon": (0.01, 1000.0, "s"),
    "wheel_separation": (0.001, 100.0, "m"),
    "logged_separation_multiplier": (0.01, 100.0, ""),
    "logged_radius_multiplier": (0.01, 100.0, ""),
    "min_turning_radius": (0.001, 10000.0, "m"),
    "wheel_base": (0.001, 100.0, "m"),
}


@dataclass(frozen=True)
class ExportOptions:
    """Numbers of the robot and of its tools that a model does not hold.

    Raises:
        SettingsError: a number makes no sense.
    """

    horizon: float = 1.0  # s; noise that lasts is spread over this time as if it were white
    wheel_separation: float | None = None  # m, nominal; needed to tell left from right wheels
    logged_separation_multiplier: float = 1.0  # in force while the log was recorded
    logged_radius_multiplier: float = 1.0  # in force while the log was recorded
    min_turning_radius: float | None = None  # m, by the geometry of an Ackermann vehicle
    nav2: Literal["rolling", "kilted"] = "rolling"  # whose parameter names MPPI gets
    wheel_base: float | None = None  # m, of a vehicle that steers
    px4: str | None = None  # version, such as 1.17
    ardupilot: str | None = None  # version, such as 4.6
    logged: Mapping[str, float] = field(
        default_factory=dict
    )  # the tool's parameters while the log was recorded

    def __post_init__(self) -> None:
        for name, (least, most, unit) in _BOUNDS.items():
            value = getattr(self, name)
            if value is not None and not least <= value <= most:
                raise SettingsError(
                    f"{name.replace('_', ' ')} is {value:g}",
                    where=f"--{name.replace('_', '-')}",
                    advice=f"give {least:g} to {most:g} {unit}".rstrip(),
                )
        for name, value in self.logged.items():
            if not math.isfinite(value):
                raise SettingsError(f"{name} was {value}", where="--logged", advice="give a finite number")
        if self.nav2 not in NAV2_NAMES:
            raise SettingsError(
                f"unknown Nav2 version '{self.nav2}'", advice=f"one of {', '.join(NAV2_NAMES)}"
            )
