# SPDX-License-Identifier: Apache-2.0
"""What an exported file depends on besides the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Literal

from slipwise.argument_types import check_arguments
from slipwise.errors import SettingsError

#: What makes sense of each number; far outside of these it has another unit.
_BOUNDS = {
    "horizon": (0.01, 1000.0, "s"),
    "wheel_separation": (0.001, 100.0, "m"),
    "logged_separation_multiplier": (0.01, 100.0, ""),
    "logged_radius_multiplier": (0.01, 100.0, ""),
    "min_turning_radius": (0.001, 10000.0, "m"),
    "wheel_base": (0.001, 100.0, "m"),
    "update_rate": (0.1, 100000.0, "Hz"),
    "planning_horizon": (0.01, 1000.0, "s"),
    "filter_rate": (0.1, 100000.0, "Hz"),
}
#: Parameters that are read as logged, by the target whose they are; places and offsets may be negative.
LOGGED = {
    "px4": ("RO_MAX_THR_SPEED", "RO_YAW_RATE_CORR", "RD_MAX_THR_YAW_R"),
    "ardupilot": (
        "ATC_STR_RAT_FF",
        "CRUISE_SPEED",
        "CRUISE_THROTTLE",
        "WENC_RADIUS",
        "WENC2_RADIUS",
        "WENC_POS_Y",
        "WENC2_POS_Y",
    ),
    "autoware": ("steering_offset",),
}
_EVERY = tuple(name for names in LOGGED.values() for name in names)
_SIGNED = ("WENC_POS_Y", "WENC2_POS_Y", "steering_offset")


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
    ros_distro: str | None = None  # release of ROS whose parameters are written, such as jazzy
    update_rate: float | None = None  # Hz, of the controller manager
    planning_horizon: float = 2.8  # s that MPPI plans ahead: time_steps times model_dt
    filter_rate: float = 30.0  # Hz, of robot_localization's filter: its frequency
    limits: bool = False  # write limits of speeds and accelerations too: they narrow what the robot may do
    stamped_commands: bool | None = None  # whether commands are TwistStamped
    omni: bool = False  # the robot drives sideways, too
    small_alphas: bool = False  # write alphas of AMCL that are below its default
    wheel_base: float | None = None  # m, of a vehicle that steers
    input_scale: Literal["log", "robot"] | None = None  # whose numbers a scale of the log's input corrects
    no_side_slip: bool = False  # the robot does not slip sideways: what looks like it is a sensor's mount
    px4: str | None = None  # version, such as 1.17
    ardupilot: str | None = None  # version, such as 4.6
    logged: Mapping[str, float] = field(
        default_factory=dict
    )  # the tool's parameters while the log was recorded

    def __post_init__(self) -> None:
        check_arguments(ExportOptions, vars(self))
        for name, (least, most, unit) in _BOUNDS.items():
            value = getattr(self, name)
            if value is not None and not least <= value <= most:
                raise SettingsError(
                    f"{name.replace('_', ' ')} is {value:g}",
                    where=f"--{name.replace('_', '-')}",
                    advice=f"give {least:g} to {most:g} {unit}".rstrip(),
                )
        for name, value in self.logged.items():
            if name not in _EVERY:
                what = f"nothing follows from {name}"
                raise SettingsError(what, where="--logged", advice=f"one of {', '.join(_EVERY)}")
            if not math.isfinite(value) or (name not in _SIGNED and not value > 0.0):
                kind = "finite" if name in _SIGNED else "positive"
                raise SettingsError(f"{name} was {value:g}", where="--logged", advice=f"give a {kind} number")

    def given(self) -> tuple[str, ...]:
        """Return the names of what is not as by default; the release of ROS may be that of the shell."""
        usual = ExportOptions(ros_distro=self.ros_distro)
        return tuple(
            each.name for each in fields(self) if getattr(self, each.name) != getattr(usual, each.name)
        )
