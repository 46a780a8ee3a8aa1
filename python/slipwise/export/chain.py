# SPDX-License-Identifier: Apache-2.0
"""The command chain of a model in plain numbers: the one place where exporters read it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.errors import ModelError
from slipwise.models.model import Model

_KNOWN = {"log_lag_v", "log_lag_omega", "log_delay_v", "log_delay_omega", "clock_offset"}


@dataclass(frozen=True)
class Chain:
    """Lag, delay and clock offset [s]; zero where the model has none."""

    lag_v: float
    lag_omega: float
    delay_v: float
    delay_omega: float
    clock_offset: float

    @property
    def mean_delay_v(self) -> float:
        """How late the speed is in all [s]: a lag loses the distance that a delay of its length does."""
        return self.delay_v + self.lag_v

    @property
    def mean_delay_omega(self) -> float:
        """How late the yaw rate is in all [s]."""
        return self.delay_omega + self.lag_omega


def chain_of(model: Model) -> Chain:
    """Return the model's chain.

    Raises:
        ModelError: the chain has a part that the exporters do not know, and would leave out.
    """
    values = {p.name: p.value for p in model.content.parameters[model.motion.slip_size :]}
    unknown = sorted(set(values) - _KNOWN)
    if unknown:
        raise ModelError(
            f"the command chain has {', '.join(unknown)}, which cannot be exported",
            advice="calibrate without it",
        )

    def seconds(name: str) -> float:
        return math.exp(values[name]) if name in values else 0.0

    return Chain(
        lag_v=seconds("log_lag_v"),
        lag_omega=seconds("log_lag_omega"),
        delay_v=seconds("log_delay_v"),
        delay_omega=seconds("log_delay_omega"),
        clock_offset=values.get("clock_offset", 0.0),
    )
