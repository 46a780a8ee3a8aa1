# SPDX-License-Identifier: Apache-2.0
"""The actuator model of a model in learned numbers: the one place where exporters read it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.models.model import Model

AT_ONCE = 0.05  # s, standard deviation up to which a delay of nothing is known

_KNOWN = {
    f"{name}_{place}"
    for name in ("log_time_constant", "log_delay", "delay", "gain", "slow_fraction", "log_slow_time_constant")
    for place in ("v", "omega")
}


@dataclass(frozen=True, eq=False)
class ChannelResponse:
    """How one channel answers a command: delay, gain, and two lags side by side."""

    time_constant: LearnedNumber  # s
    delay: LearnedNumber  # s
    gain: LearnedNumber
    slow_fraction: LearnedNumber  # of the answer that follows by the slow lag
    slow_time_constant: LearnedNumber  # s; zero where there is no slow mode

    held: float | None = None  # s, for which the log's inputs were held; None: the model does not say

    @property
    def objection(self) -> str:
        """Why the lag must not be handed on; empty where it may be."""
        if self.held is None or self.mean_lag.value <= self.held:
            return ""
        if self.held == 0.0:
            return f"a lag of {self.mean_lag.value:.3g} s was learned, but no command was held in the log"
        return (
            f"a lag of {self.mean_lag.value:.3g} s was learned, longer than commands were held in the log"
            f" ({self.held:.3g} s): its end was never seen"
        )

    @property
    def mean_lag(self) -> LearnedNumber:
        """The time constant of one lag that loses as much distance [s]."""
        return self.time_constant + self.slow_fraction * (self.slow_time_constant + self.time_constant * -1.0)

    @property
    def mean_delay(self) -> LearnedNumber:
        """How late the channel is in all [s]: a lag loses the distance that a delay of its length does.

        Never less than nothing, which only an offset of the clocks can make of a delay.
        """
        late = self.delay + self.mean_lag
        return late if late.value > 0.0 else late * 0.0

    def delay_objection(self, numbers: LearnedNumbers) -> str:
        """Say why it must not be handed on that the channel is not late; empty where it is, or may be."""
        late = self.delay + self.mean_lag
        unknown = late.value <= 0.0 and numbers.std(late) > AT_ONCE
        return f"{numbers.text(late)} s of delay is too uncertain" if unknown else ""


@dataclass(frozen=True, eq=False)
class Actuator:
    """Its channels."""

    v: ChannelResponse
    omega: ChannelResponse


def actuator_of(model: Model) -> Actuator:
    """Return the model's actuator.

    Raises:
        ModelError: the actuator has a part that the exporters do not know, and would leave out.
    """
    parameters = model.body.vector.rows
    places = {p.name: i for i, p in enumerate(parameters) if i >= model.motion.slip_size}
    unknown = sorted(set(places) - _KNOWN)
    if unknown:
        raise ModelError(
            f"the actuator model has {', '.join(unknown)}, which cannot be exported",
            advice="calibrate without it",
        )
    numbers, body = LearnedNumbers(model.body), model.content.range.body

    def seconds(name: str) -> LearnedNumber:
        if name not in places:
            return numbers.exactly(0.0)
        return numbers.seconds(places[name], parameters[places[name]].value)

    def plain(name: str, absent: float) -> LearnedNumber:
        if name not in places:
            return numbers.exactly(absent)
        return numbers.of_parameters(parameters[places[name]].value, np.eye(len(parameters))[places[name]])

    def channel(place: str) -> ChannelResponse:
        return ChannelResponse(
            time_constant=seconds(f"log_time_constant_{place}"),
            delay=plain(f"delay_{place}", 0.0) + seconds(f"log_delay_{place}"),
            gain=plain(f"gain_{place}", 1.0),
            slow_fraction=plain(f"slow_fraction_{place}", 0.0),
            slow_time_constant=seconds(f"log_slow_time_constant_{place}"),
            held=None if body is None else body.held[("v", "omega").index(place)],
        )

    return Actuator(channel("v"), channel("omega"))
