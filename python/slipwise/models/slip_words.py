# SPDX-License-Identifier: Apache-2.0
"""How far a robot drives and turns for what is commanded, in words."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np

from slipwise.models.body_gains import body_twists, sideways_twists
from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter, known
from slipwise.number_text import estimate_text, list_text

LEARNED = 0.15  # standard deviation up to which a gain of the actuator is learned; that of its prior is 0.2
AS_COMMANDED = 0.02  # a gain of the actuator that is known to be so close to one is not worth a sentence


@dataclass(frozen=True)
class Gain:
    """What comes out per unit of what goes in."""

    value: float
    std: float

    @property
    def identified(self) -> bool:
        """Whether it is known to the stated fraction."""
        return known(self.value, self.std) and self.std > 0.0

    def times(self, other: Gain) -> Gain:
        """Return the product of two gains whose errors are independent."""
        value = self.value * other.value
        return Gain(value, hypot(self.std * other.value, other.std * self.value))

    def percent(self) -> str:
        """Return the gain in percent."""
        return estimate_text(100.0 * self.value, 100.0 * self.std) + " %"


@dataclass(frozen=True)
class SlipGains:
    """Speeds and yaw rate of the body over those of its wheels: straight lines over the range of the log."""

    speed: Gain
    sideways: Gain | None  # None of a base that does not drive to its sides
    yaw_rate: Gain
    separation: Gain | None  # wheel-separation multiplier: the speed gain over that of the yaw rate


def slip_gains(model: Model) -> SlipGains:
    """Return the gains of the body, with the standard deviations that follow from the covariance.

    A gain has no standard deviation where the log never drove, or never turned, or where no slip is learned.
    """
    body = body_twists(model)
    size = model.motion.slip_size
    covariance = model.covariance[:size, :size]
    speed, by_speed = body.line(0, body.v)
    yaw, by_yaw = body.line(2, body.w)
    ratio = speed[0] / yaw[0] if yaw[0] else np.nan
    by_ratio = (by_speed[0] - ratio * by_yaw[0]) / yaw[0] if yaw[0] else by_yaw[0]

    def gain(value: float, derivative: np.ndarray) -> Gain:
        return Gain(float(value), float(np.sqrt(max(derivative @ covariance @ derivative, 0.0))))

    gains = gain(speed[0], by_speed[0]), gain(yaw[0], by_yaw[0])
    if (sides := sideways_twists(model)) is None:
        return SlipGains(gains[0], None, gains[1], gain(ratio, by_ratio))
    left, by_left = sides.line(1, sides.vy)
    return SlipGains(gains[0], gain(left[0], by_left[0]), gains[1], None)


def slip_sentences(model: Model, parameters: tuple[PhysicalParameter, ...]) -> list[str]:
    """Say how much of what is commanded the robot does, and how much of that its wheels do."""
    if model.motion.slip_size == 0:
        return ["Slip is not part of this model."]
    slip, actuator = slip_gains(model), _actuator_gains(model, parameters)
    exact = all(abs(g.value - 1.0) <= AS_COMMANDED and g.std <= AS_COMMANDED for g in actuator.values())
    if model.content.input == "wheel":
        return [_moves(slip, "its wheels say", _separation(slip.separation))]
    if not exact:
        return [_moves(slip, "its wheels say"), *_reaches(actuator)]
    of_speed, of_turn = actuator.values()
    sideways = None if slip.sideways is None else slip.sideways.times(of_speed)
    all_in_all = SlipGains(slip.speed.times(of_speed), sideways, slip.yaw_rate.times(of_turn), None)
    return [_moves(all_in_all, "is commanded" if model.car is None else "its curves say")]


def _moves(gains: SlipGains, source: str, besides: str = "") -> str:
    ways = (("drives", gains.speed), ("goes sideways", gains.sideways), ("turns", gains.yaw_rate))
    parts = [f"{verb} {gain.percent()}" for verb, gain in ways if gain is not None and gain.identified]
    if not parts:
        return "The log does not identify how much the robot slips."
    sentence = f"{list_text(parts, 'and')} of what {source}{besides}."
    return sentence[0].upper() + sentence[1:]


def _separation(multiplier: Gain | None) -> str:
    """The multiplier that wheel odometry takes; commands do not tell it from what the drive makes of them."""
    if multiplier is None or not (multiplier.identified and multiplier.value > 0.0):
        return ""
    return f" (separation multiplier {estimate_text(multiplier.value, multiplier.std)})"


def _actuator_gains(model: Model, parameters: tuple[PhysicalParameter, ...]) -> dict[str, Gain]:
    """Return the gain of each axis of commands by its name."""
    found = {p.name: Gain(p.value, p.std) for p in parameters}
    exact = Gain(1.0, 0.0)
    turn = "yaw rate" if model.content.wheelbase is None else "steering"
    return {"speed": found.get("gain_v", exact), turn: found.get("gain_omega", exact)}


def _reaches(actuator: dict[str, Gain]) -> list[str]:
    parts = [
        f"{gain.percent()} of the commanded {name}" for name, gain in actuator.items() if gain.std <= LEARNED
    ]
    return [f"Its wheels reach {' and '.join(parts)}."] if parts else []
