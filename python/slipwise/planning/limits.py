# SPDX-License-Identifier: Apache-2.0
"""What a robot may be commanded to do, and what it is doing when a plan begins."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.model import Model

ACCELERATION = 0.5  # m/s^2, where the user says nothing


@dataclass(frozen=True)
class Limits:
    """Limits of the commands, not of what the robot makes of them; all are positive.

    Raises:
        SettingsError: a limit is not positive and finite.
    """

    speed: float  # m/s, forwards and backwards
    yaw_rate: float  # rad/s
    curvature: float  # 1/m, of yaw rate over speed
    acceleration: float = ACCELERATION  # m/s^2, also when braking

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (math.isfinite(value) and value > 0.0):
                raise SettingsError(
                    f"the limit {field.name} is {value}", where=field.name, advice="give a positive number"
                )

    def to_core(self) -> _core.DriveLimits:
        """Return the limits as the core takes them."""
        return _core.DriveLimits(self.speed, self.yaw_rate, self.curvature, self.acceleration)


def limits_of(model: Model) -> Limits:
    """Return limits within which the model was learned; the curvature is that of full turning at half speed.

    A robot that steers may turn no tighter than it did, or than at full speed where that is not known.
    Where the drive has learned limits, the tighter of the two hold; so that its ramps keep up with the
    commands, the acceleration is no more than it accelerates and brakes with.

    Raises:
        SettingsError: the model has never seen the robot drive or turn.
    """
    speed = max(abs(value) for value in model.content.range.speed)
    yaw_rate = max(abs(value) for value in model.content.range.yaw_rate)
    acceleration = ACCELERATION
    learned = model.limits
    if learned is not None:
        sides = learned.side
        speed = min(speed, learned.speed.saturation, sides.saturation / learned.gain_v)
        yaw_rate = min(yaw_rate, learned.yaw_rate.saturation)
        own = (learned.speed.slew_rate_up, learned.speed.slew_rate_down)
        acceleration = min(
            acceleration, *own, sides.slew_rate_up / learned.gain_v, sides.slew_rate_down / learned.gain_v
        )
    if speed <= 0.0 or yaw_rate <= 0.0:
        raise SettingsError(
            "the model was learned from a drive without speed or without turning",
            advice="give limits, or calibrate on a drive that has both",
        )
    curvature = (1.0 if model.steers else 2.0) * yaw_rate / speed
    curvature = max(curvature, model.content.range.curvature or 0.0)  # that is known of robots that steer
    return Limits(speed=speed, yaw_rate=yaw_rate, curvature=curvature, acceleration=acceleration)


@dataclass(frozen=True)
class DriveState:
    """What the drive does (behind its lag) and its last command; all forward [m/s] and turning [rad/s].

    Where the model has a slow mode, `fast` is what of the drive is not the slow mode's; without it, the drive
    is taken to have followed what it was commanded for long.

    Raises:
        SettingsError: a value is not finite.
    """

    drive: tuple[float, float] = (0.0, 0.0)
    commanded: tuple[float, float] = (0.0, 0.0)
    fast: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (*self.drive, *self.commanded, *(self.fast or ())))):
            raise SettingsError("the speeds at the start are not finite", advice="such as drive=(0.5, 0.0)")

    def to_core(self) -> _core.ActuatorState:
        """Return the state as the core takes it."""
        fast = None if self.fast is None else _twist(self.fast)
        return _core.ActuatorState(_twist(self.drive), _twist(self.commanded), fast)


def _twist(values: tuple[float, float]) -> _core.BodyTwist:
    return _core.BodyTwist(values[0], 0.0, values[1])


AT_REST = DriveState()
