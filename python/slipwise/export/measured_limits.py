# SPDX-License-Identifier: Apache-2.0
"""Limits of the body for other tools: what the poses measured, and learned limits that fit that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slipwise.export.body_limits import BodyLimits, strictest
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.models.model import Model
from slipwise.models.schema import MeasuredBody

NOT_MEASURED = "the model file does not say how fast the body moved: calibrate again with this slipwise"
TOO_RARE = "the poses are too rare to say how fast the body moved"
CHOSEN = "limits are written where they are asked for alone: give --limits"
AS_FAR = "as fast as the poses show the body"


@dataclass(frozen=True, eq=False)
class Limit:
    """A bound of the body, as a magnitude, and where it comes from."""

    number: LearnedNumber
    source: str


class MeasuredLimits:
    """Answers how far each rate of the body went; none is stricter than what the log itself shows.

    Args:
        model: whose log was measured.
        learned: limits of the drive that were learned, as limits of the body.
        numbers: of the model.
    """

    def __init__(self, model: Model, learned: BodyLimits, numbers: LearnedNumbers) -> None:
        self._body = model.content.range.body
        self._driven_back = model.content.range.speed[0] < 0.0
        self._learned, self._numbers = learned, numbers

    def forward(self) -> Limit | str:
        """Speed ahead [m/s]."""
        return self._top(lambda body: body.speed[1])

    def backward(self) -> Limit | str:
        """Speed in reverse [m/s]; 0 where it was never driven so, whatever noise of poses shows."""
        return self._top(lambda body: -body.speed[0] if self._driven_back else 0.0)

    def turn(self) -> Limit | str:
        """Yaw rate to the side where it went further [rad/s]."""
        return self._top(lambda body: max(map(abs, body.yaw_rate)))

    def acceleration(self, *more: Limit) -> Limit | str:
        """Away from standstill [m/s^2], by the strictest of what was learned and `more`."""
        return self._rate(self._learned.slew_rate_up_v, "acceleration", 0, more)

    def braking(self, *more: Limit) -> Limit | str:
        """Towards standstill [m/s^2]."""
        return self._rate(self._learned.slew_rate_down_v, "acceleration", 1, more)

    def yaw_acceleration(self, *more: Limit) -> Limit | str:
        """Away from no turn [rad/s^2]."""
        return self._rate(self._learned.slew_rate_up_omega, "yaw_acceleration", 0, more)

    def yaw_braking(self, *more: Limit) -> Limit | str:
        """Towards no turn [rad/s^2]."""
        return self._rate(self._learned.slew_rate_down_omega, "yaw_acceleration", 1, more)

    def _top(self, of: Callable[[MeasuredBody], float]) -> Limit | str:
        body = self._measured()
        return body if isinstance(body, str) else Limit(self._numbers.exactly(of(body)), AS_FAR)

    def _rate(
        self, learned: Sequence[LearnedNumber], name: str, place: int, more: Sequence[Limit]
    ) -> Limit | str:
        what = (
            name.replace("_", " ")
            if place == 0
            else name.replace("acceleration", "braking").replace("_", " ")
        )
        found = [Limit(number, f"the drive's learned limit of the {what}") for number in learned]
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
