# SPDX-License-Identifier: Apache-2.0
"""The command chain of a model in plain numbers: the one place where exporters read it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.errors import ModelError
from slipwise.models.model import Model

_KNOWN = {"clock_offset"} | {
    f"{name}_{place}"
    for name in ("log_lag", "log_delay", "gain", "slow_share", "log_slow_lag")
    for place in ("v", "omega")
}


@dataclass(frozen=True)
class ChannelResponse:
    """How one channel answers a command: delay, gain, and two lags side by side."""

    lag: float  # s
    delay: float  # s
    gain: float
    slow_share: float  # of the answer that follows by the slow lag
    slow_lag: float  # s; zero where there is no slow part

    @property
    def mean_lag(self) -> float:
        """The time constant of one lag that loses as much distance [s]."""
        return (1.0 - self.slow_share) * self.lag + self.slow_share * self.slow_lag

    @property
    def mean_delay(self) -> float:
        """How late the channel is in all [s]: a lag loses the distance that a delay of its length does."""
        return self.delay + self.mean_lag


@dataclass(frozen=True)
class Chain:
    """The channels, and how much later than the inputs poses are stamped [s]."""

    v: ChannelResponse
    omega: ChannelResponse
    clock_offset: float


def chain_of(model: Model) -> Chain:
    """Return the model's chain.

    Raises:
        ModelError: the chain has a part that the exporters do not know, and would leave out.
    """
    values = {p.name: p.value for p in model.body.content.parameters[model.motion.slip_size :]}
    unknown = sorted(set(values) - _KNOWN)
    if unknown:
        raise ModelError(
            f"the command chain has {', '.join(unknown)}, which cannot be exported",
            advice="calibrate without it",
        )

    def seconds(name: str) -> float:
        return math.exp(values[name]) if name in values else 0.0

    def channel(place: str) -> ChannelResponse:
        return ChannelResponse(
            lag=seconds(f"log_lag_{place}"),
            delay=seconds(f"log_delay_{place}"),
            gain=values.get(f"gain_{place}", 1.0),
            slow_share=values.get(f"slow_share_{place}", 0.0),
            slow_lag=seconds(f"log_slow_lag_{place}"),
        )

    return Chain(channel("v"), channel("omega"), values.get("clock_offset", 0.0))
