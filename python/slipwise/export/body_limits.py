# SPDX-License-Identifier: Apache-2.0
"""Learned limits of the drive, those of its sides too, as limits of the body's speed and yaw rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.models.body_gains import BodyTwists
from slipwise.models.limits import LearnedLimit, LimitsSection

Gains = tuple[LearnedNumber, LearnedNumber]  # of the body over the input, speed and yaw rate


@dataclass(frozen=True, eq=False)
class BodyLimits:
    """What bounds the body's speed (v) and yaw rate (omega); none of several may be passed."""

    saturation_v: Sequence[LearnedNumber] = ()  # m/s
    saturation_omega: Sequence[LearnedNumber] = ()  # rad/s
    slew_rate_up_v: Sequence[LearnedNumber] = ()  # m/s^2
    slew_rate_up_omega: Sequence[LearnedNumber] = ()  # rad/s^2
    slew_rate_down_v: Sequence[LearnedNumber] = ()  # m/s^2
    slew_rate_down_omega: Sequence[LearnedNumber] = ()  # rad/s^2


def slip_gains(numbers: LearnedNumbers, twists: BodyTwists) -> Gains:
    """Return body speed per speed and body yaw rate per yaw rate, by least squares."""
    speed, by_speed = twists.line(0, twists.v)
    yaw, by_yaw = twists.line(2, twists.w)
    return (
        numbers.of_parameters(float(speed[0]), by_speed[0]),
        numbers.of_parameters(float(yaw[0]), by_yaw[0]),
    )


def reached_text(gains: Gains, numbers: LearnedNumbers) -> str:
    """Say how much of a command the robot reaches."""
    speed, yaw = (
        f"an unknown part of the {what}"
        if numbers.objection(gain)
        else f"{gain.value:.3f} of the {what} (+- {numbers.std(gain):.2g})"
        for gain, what in zip(gains, ("speed", "yaw rate"), strict=True)
    )
    return f"reaches {speed} and {yaw}"


def body_limits(limits: LimitsSection | None, gains: Gains, numbers: LearnedNumbers) -> BodyLimits:
    """Fold the limits of speed, yaw rate and sides into those of the body.

    A side at its limit a leaves the body a in speed, or 2 a / separation in yaw rate, where it does not do
    both. What the body does beyond its drive is never counted on.

    Args:
        limits: as the model has them.
        gains: of the body over what is behind the limits.
        numbers: of the model.
    """
    if limits is None:
        return BodyLimits()
    speed, yaw_rate, side = limits.speed, limits.yaw_rate, limits.side
    apart = numbers.limit(LearnedLimit(value=limits.wheel_separation, std=limits.wheel_separation_std))

    def of_speed(own: LearnedLimit | None, of_side: LearnedLimit | None) -> list[LearnedNumber]:
        found = [] if own is None else [numbers.limit(own) * limits.gain_v * gains[0]]
        return found if of_side is None else [*found, _at_most_drive(numbers.limit(of_side), gains[0])]

    def of_yaw(own: LearnedLimit | None, of_side: LearnedLimit | None) -> list[LearnedNumber]:
        found = [] if own is None else [numbers.limit(own) * limits.gain_omega * gains[1]]
        if of_side is None:
            return found
        return [*found, _at_most_drive(numbers.limit(of_side) * 2.0 / apart, gains[1])]

    return BodyLimits(
        saturation_v=of_speed(speed.saturation, side.saturation),
        saturation_omega=of_yaw(yaw_rate.saturation, side.saturation),
        slew_rate_up_v=of_speed(speed.slew_rate_up, side.slew_rate_up),
        slew_rate_up_omega=of_yaw(yaw_rate.slew_rate_up, side.slew_rate_up),
        slew_rate_down_v=of_speed(speed.slew_rate_down, side.slew_rate_down),
        slew_rate_down_omega=of_yaw(yaw_rate.slew_rate_down, side.slew_rate_down),
    )


def strictest(found: Sequence[LearnedNumber], numbers: LearnedNumbers) -> LearnedNumber:
    """Return the smallest of the bounds that may be stated; where none may, the smallest."""
    usable = [number for number in found if not numbers.objection(number)]
    return min(usable or found, key=lambda number: abs(number.value))


def _at_most_drive(limit: LearnedNumber, gain: LearnedNumber) -> LearnedNumber:
    return limit * gain if gain.value < 1.0 else limit
