# SPDX-License-Identifier: Apache-2.0
"""How late and how slowly a robot follows its commands, in words."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot

from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter
from slipwise.number_text import estimate_text

Found = Mapping[str, PhysicalParameter]

SAME = 2.0  # standard deviations of a difference; channels closer than that are said to be alike
ALIKE = 0.1  # or closer than this fraction
LARGEST_HIDDEN = 0.1  # std of the slow fraction up to which a slow mode may be left unsaid


def response_sentences(model: Model, parameters: tuple[PhysicalParameter, ...]) -> list[str]:
    """Say delays and time constants, of speed and yaw rate together where these are alike."""
    if model.content.input != "command":
        return []
    found = {p.name: p for p in parameters}
    if not any(name.startswith(("time_constant_", "delay_")) for name in found):
        return ["Follows commands at once."]
    channels = {"speed commands": _channel(found, "v"), "yaw-rate commands": _channel(found, "omega")}
    if _alike(found, channels):
        return [f"Follows commands {channels['speed commands']}."]
    said = [f"{name} {words}" for name, words in channels.items() if words]
    return [f"Follows {', and '.join(said)}."] if said else []


def _channel(found: Found, place: str) -> str:
    parts = []
    delay, lagging = found.get(f"delay_{place}"), f"time_constant_{place}" in found
    if delay is not None and delay.identified:
        late = lagging or delay.value > SAME * delay.std
        parts.append(f"after {_seconds(delay)}" if late else "at once")
    constants = _time_constants(found, place)
    if constants:
        parts.append(f"with {constants}")
    return " and ".join(parts)


def _time_constants(found: Found, place: str) -> str:
    """One time constant, or those of a fast and a slow mode; nothing where they are not identified."""
    lag = found.get(f"time_constant_{place}")
    if lag is None or not lag.identified:
        return ""
    slow, slow_time_constant = found.get(f"slow_fraction_{place}"), found.get(f"slow_time_constant_{place}")
    one = f"a time constant of {_seconds(lag)}"
    if slow is None or slow_time_constant is None:
        return one
    if abs(slow.value) <= SAME * slow.std:
        return one if slow.std <= LARGEST_HIDDEN else ""
    if not (slow.identified and slow_time_constant.identified):
        return ""
    percent = estimate_text(100.0 * slow.value, 100.0 * slow.std)
    return f"{one} ({percent} % of it with a slower one of {_seconds(slow_time_constant)})"


def _seconds(parameter: PhysicalParameter) -> str:
    return f"{estimate_text(parameter.value, parameter.std)} s"


def _alike(found: Found, channels: Mapping[str, str]) -> bool:
    """Whether both channels say the same things with numbers that agree."""
    if not all(channels.values()) or any("slower" in words for words in channels.values()):
        return False
    said = [tuple(word in words for word in ("after", "with")) for words in channels.values()]
    return said[0] == said[1] and all(
        _agree(found[f"{kind}_v"], found[f"{kind}_omega"])
        for kind, is_said in zip(("delay", "time_constant"), said[0], strict=True)
        if is_said
    )


def _agree(first: PhysicalParameter, second: PhysicalParameter) -> bool:
    difference = abs(first.value - second.value)
    return difference <= max(SAME * hypot(first.std, second.std), ALIKE * min(first.value, second.value))
