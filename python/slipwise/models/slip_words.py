# SPDX-License-Identifier: Apache-2.0
"""How far a robot drives and turns for what is commanded, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.models.body_gains import body_twists, gains_at_sides, sideways_twists
from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter, known
from slipwise.number_text import estimate_text, list_text, number_text

Floats = NDArray[np.float64]

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

    def percent(self) -> str:
        """Return the gain in percent; a model does not say how well a gain in front of limits is known."""
        if self.std == 0.0:
            return f"{number_text(100.0 * self.value)} %"
        return estimate_text(100.0 * self.value, 100.0 * self.std) + " %"


@dataclass(frozen=True)
class SlipGains:
    """Speeds and yaw rate of the body over those that go in: straight lines over the range of the log."""

    speed: Gain
    sideways: Gain | None  # None of a base that does not drive to its sides
    yaw_rate: Gain
    separation: Gain | None  # wheel-separation multiplier: the speed gain over that of the yaw rate


def slip_gains(model: Model) -> SlipGains:
    """Return the gains of the body over its wheels, with the deviations that follow from the covariance.

    A gain has no standard deviation where the log never drove, or never turned, or where no slip is learned.
    """
    return _gains(model, through_drive=False)


def whole_gains(model: Model) -> SlipGains:
    """Return the gains of the body over what is commanded, or over what the wheels say: slip and drive.

    The poses show the product, so it is known better than either: their errors are not independent.
    """
    return _gains(model, through_drive=True)


def _gains(model: Model, *, through_drive: bool) -> SlipGains:
    body, size, names = body_twists(model), model.motion.slip_size, model.vector.names
    covariance = model.covariance
    before = gains_at_sides(model) if through_drive else (1.0, 1.0)

    def gain(slip: float, by_slip: Floats, drive: str = "", factor: float = 1.0) -> Gain:
        """Return slip times a factor, times what the drive makes of its input where that is learned."""
        by = np.zeros(len(names))
        by[:size] = factor * by_slip
        value = factor * slip
        if through_drive and drive in names:
            place = names.index(drive)
            by *= model.mean[place]
            by[place] = value
            value *= model.mean[place]
        return Gain(float(value), max(float(by @ covariance @ by), 0.0) ** 0.5)

    speed, by_speed = body.line(0, body.v)
    yaw, by_yaw = body.line(2, body.w)
    of_speed = gain(speed[0], by_speed[0], "gain_v", before[0])
    of_turn = gain(yaw[0], by_yaw[0], "gain_omega", before[1])
    if (sides := sideways_twists(model)) is not None:
        left, by_left = sides.line(1, sides.vy)
        return SlipGains(of_speed, gain(left[0], by_left[0], "gain_v", before[0]), of_turn, None)
    ratio = speed[0] / yaw[0] if yaw[0] else np.nan
    by_ratio = (by_speed[0] - ratio * by_yaw[0]) / yaw[0] if yaw[0] else by_yaw[0]
    return SlipGains(of_speed, None, of_turn, gain(ratio, by_ratio))


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
    return [_moves(whole_gains(model), "is commanded" if model.car is None else "its curves say")]


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
    learned = {p.name: p for p in parameters}
    turn = "yaw rate" if model.content.wheelbase is None else "steering"
    found = {}
    for axis, name, factor in zip(
        ("speed", turn), ("gain_v", "gain_omega"), gains_at_sides(model), strict=True
    ):
        gain = learned.get(name)
        found[axis] = Gain(factor, 0.0) if gain is None else Gain(factor * gain.value, factor * gain.std)
    return found


def _reaches(actuator: dict[str, Gain]) -> list[str]:
    parts = [
        f"{gain.percent()} of the commanded {name}" for name, gain in actuator.items() if gain.std <= LEARNED
    ]
    return [f"Its wheels reach {' and '.join(parts)}."] if parts else []
