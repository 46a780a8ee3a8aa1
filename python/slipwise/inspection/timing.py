# SPDX-License-Identifier: Apache-2.0
"""How late poses are against the inputs: the clock offset of wheel speeds, delay and lag of commands."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.inspection.learnability import Learnability, LearnableParameter


@dataclass(frozen=True)
class Timing:
    """A time between inputs and poses."""

    input: str  # "command" or "wheel"
    name: str
    seconds: float  # s
    std: float  # s
    identifiable: bool
    meaning: str


_MEANINGS = {
    "clock_offset": "poses come this much later than wheel speeds, by their stamps or a body that lags",
    "delay_v": "from a speed command to the speed, with no lag",
    "delay_omega": "from a yaw rate command to the yaw rate, with no lag",
    "log_delay_v": "from a speed command to the first effect",
    "log_delay_omega": "from a yaw rate command to the first effect",
    "log_time_constant_v": "then the speed follows with this time constant",
    "log_time_constant_omega": "then the yaw rate follows with this time constant",
    "log_slow_time_constant_v": "a part of the speed follows with this time constant",
    "log_slow_time_constant_omega": "a part of the yaw rate follows with this time constant",
}


def timing_of(learned: Learnability) -> tuple[Timing, ...]:
    """Return the times that were learned, in s; none where nothing could be learned.

    Where commands were learned by way of the wheel speeds, the clock offset is that of the wheel speeds, and
    said there.
    """
    apart = learned.input == "command" and learned.parameter("clock_offset") is not None
    found = [(learned.parameter(name), meaning) for name, meaning in _MEANINGS.items()]
    known = [
        (p, meaning) for p, meaning in found if p is not None and not (apart and p.name == "clock_offset")
    ]
    included = "" if apart else ", clock offset included"
    return tuple(
        _timing(learned.input, p, meaning + (included if "delay" in p.name else "")) for p, meaning in known
    )


def _timing(input_name: str, parameter: LearnableParameter, meaning: str) -> Timing:
    name = parameter.name.removeprefix("log_")
    seconds, std = parameter.value, parameter.std
    if name != parameter.name:
        seconds, std = math.exp(seconds), math.exp(seconds) * std
    return Timing(input_name, name, seconds, std, parameter.identifiable, meaning)
