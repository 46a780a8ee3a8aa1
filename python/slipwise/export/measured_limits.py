# SPDX-License-Identifier: Apache-2.0
"""Limits of the body for other tools: what the poses measured, and learned limits that fit that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slipwise.export.actuator import actuator_of
from slipwise.export.body_limits import Gains, body_limits, slip_gains, strictest
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.models.body_gains import body_twists, gains_at_sides
from slipwise.models.model import Model
from slipwise.models.schema import MeasuredBody

NOT_MEASURED = "the model file does not say how fast the body moved: calibrate again with this slipwise"
TOO_RARE = "the poses are too rare to say how fast the body moved"
CHOSEN = "limits are written where they are asked for alone: give --limits"
AS_FAR = "as fast as the poses show the body"


@dataclass(frozen=True, eq=False)
class Quantity:
    """A number, and how it was found; a bound of the body is a magnitude."""

    number: LearnedNumber
    source: str


Answer = Quantity | str  # or why there is none


class MeasuredLimits:
    """Answers how far each rate of the body went; none is stricter than what the log itself shows.

    Args:
        model: whose log was measured.
        numbers: of the model.

    Attributes:
        actuator: of the model.
        gains: of the body's speed and yaw rate over those that are commanded.
        behind: the same over what is behind the drive's limits.
        learned: limits of the drive that were learned, as limits of the body.
    """

    def __init__(self, model: Model, numbers: LearnedNumbers) -> None:
        self._body = model.content.range.body
        self._driven_back = model.content.range.speed[0] < 0.0
        self._numbers = numbers
        self.actuator = actuator_of(model)
        slip = slip_gains(numbers, body_twists(model))
        self.behind: Gains = (self.actuator.v.gain * slip[0], self.actuator.omega.gain * slip[1])
        before = gains_at_sides(model)
        self.gains: Gains = (self.behind[0] * before[0], self.behind[1] * before[1])
        self.learned = body_limits(model.limits_section, self.behind, numbers)

    def top_speed(self) -> Answer:
        """Speed ahead [m/s]."""
        return self._top(lambda body: body.speed[1])

    def top_speed_back(self) -> Answer:
        """Speed in reverse [m/s]; 0 where it was never driven so, whatever noise of poses shows."""
        return self._top(lambda body: -body.speed[0] if self._driven_back else 0.0)

    def top_yaw_rate(self) -> Answer:
        """Yaw rate to the side where it went further [rad/s]."""
        return self._top(lambda body: max(map(abs, body.yaw_rate)))

    def acceleration(self, *more: Quantity) -> Answer:
        """Away from standstill [m/s^2], by the strictest of what was learned and `more`."""
        return self._rate(self.learned.slew_rate_up_v, "acceleration", 0, more)

    def braking(self, *more: Quantity) -> Answer:
        """Towards standstill [m/s^2]."""
        return self._rate(self.learned.slew_rate_down_v, "acceleration", 1, more)

    def yaw_acceleration(self, *more: Quantity) -> Answer:
        """Away from no turn [rad/s^2]."""
        return self._rate(self.learned.slew_rate_up_omega, "yaw_acceleration", 0, more)

    def yaw_braking(self, *more: Quantity) -> Answer:
        """Towards no turn [rad/s^2]."""
        return self._rate(self.learned.slew_rate_down_omega, "yaw_acceleration", 1, more)

    def _top(self, of: Callable[[MeasuredBody], float]) -> Answer:
        body = self._measured()
        return body if isinstance(body, str) else Quantity(self._numbers.exactly(of(body)), AS_FAR)

    def _rate(
        self, learned: Sequence[LearnedNumber], name: str, place: int, more: Sequence[Quantity]
    ) -> Answer:
        what = (
            name.replace("_", " ")
            if place == 0
            else name.replace("acceleration", "braking").replace("_", " ")
        )
        found = [Quantity(number, f"the drive's learned limit of the {what}") for number in learned]
        found += more
        if not found:
            return f"this log shows no limit of the {what}"
        body = self._measured()
        if isinstance(body, str):
            return body
        least = strictest([each.number for each in found], self._numbers)
        chosen = next(each for each in found if each.number is least)
        shown: float = getattr(body, name)[place]
        if abs(least.value) < shown:
            return f"{abs(least.value):.3g} ({chosen.source}) is below {shown:.3g}, which the poses show"
        return chosen

    def _measured(self) -> MeasuredBody | str:
        if self._body is None:
            return NOT_MEASURED
        return self._body if self._body.seconds > 0.0 else TOO_RARE
