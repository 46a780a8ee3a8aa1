# SPDX-License-Identifier: Apache-2.0
"""How late and how slowly a robot follows its commands, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import hypot

from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter, known, physical_name
from slipwise.models.slip_words import LEARNED
from slipwise.models.step_response import SOON, StepResponse, step_responses
from slipwise.number_text import estimate_text

Found = Mapping[str, PhysicalParameter]

SAME = 2.0  # standard deviations of a difference; channels closer than that are said to be alike
LEAST_SLOW = 0.02  # of a step; a slow mode below it is none
LARGEST_HIDDEN = 0.1  # std of the slow fraction up to which a slow mode may be left unsaid
Channels = Mapping[str, str]


@dataclass(frozen=True)
class _Said:
    """The words for one channel: identified estimates alone, None where one is not."""

    delay: tuple[float, float] | None  # s
    at_once: bool  # the delay is known to be as good as none, and there is nothing else
    lags: bool  # there is a lag behind the delay
    lag: tuple[float, float] | None  # s
    slower: str  # of a slow mode
    risen: tuple[float, float] | None  # s until 63 % of a step are there, all together

    @property
    def words(self) -> str:
        parts = []
        if self.delay is not None:
            least = " at least" if self.lags and self.lag is None and self.risen is None else ""
            parts.append("at once" if self.at_once else f"after {_seconds(self.delay)}{least}")
        if self.lag is not None:
            parts.append(f"with a time constant of {_seconds(self.lag)}{self.slower}")
        if self.risen is None:
            return " and ".join(parts)
        total = f"63 % of a step after {_seconds(self.risen)}"
        return f"{' and '.join(parts)} ({total})" if parts else f"with {total}"


def response_sentences(model: Model, parameters: tuple[PhysicalParameter, ...]) -> list[str]:
    """Say how late each axis is, together where they are alike, and how much of a step arrives."""
    if model.content.input != "command":
        return []
    unknown = set(map(physical_name, model.content.verdict.not_identifiable))
    found = {p.name: replace(p, identified=p.identified and p.name not in unknown) for p in parameters}
    if model.car is not None:
        return _car_sentences(model, found)
    if not any(name.startswith(("time_constant_", "delay_")) for name in found):
        return ["Follows commands at once."]
    channels = {"v": "speed", "omega": "yaw-rate" if model.content.wheelbase is None else "steering"}
    responses = dict(zip(channels, step_responses(model), strict=True))
    said = {place: _said(found, place, responses[place]) for place in channels}
    late = any(each.delay is not None and not each.lags and not each.at_once for each in said.values())
    together = ["How much of that is a lag is not known."] if late else []
    return [*_follows(channels, said), *together, *_arrives(channels, found, responses)]


def _car_sentences(model: Model, found: Found) -> list[str]:
    """Say how fast and how tight a car drives at the largest commands that it was given, and how soon."""
    span, sentences = model.content.range, []
    for curve, driven, words in (
        ("speed", span.throttle, "At a throttle of {at:g} it drives {value} m/s."),
        ("curvature", span.steering, "At a steering of {at:g} its path has a curvature of {value} 1/m."),
    ):
        low, high = driven or (-1.0, 1.0)
        knots = [
            (row.at, found[row.name]) for row in model.table.rows if row.name.startswith(f"car.{curve}(")
        ]
        inside = [(at, p) for at, p in knots if at is not None and low <= at <= high and p.identified]
        if inside:
            at, p = max(inside, key=lambda each: each[0])
            sentences.append(words.format(at=at, value=estimate_text(p.value, p.std)))
    lags = [
        f"{what} with a time constant of {_seconds((found[name].value, found[name].std))}"
        for name, what in (("car.lag", "the throttle"), ("car.steering_lag", "the steering"))
        if found[name].identified
    ]
    delay = found.get("car.delay")  # files of earlier releases have none
    known_delay = delay is not None and delay.identified and delay.value > 0.0
    after = f"commands after {_seconds((delay.value, delay.std))}, " if delay and known_delay else ""
    return [*sentences, f"Follows {after}{' and '.join(lags)}."] if lags else sentences


def _follows(channels: Channels, said: Mapping[str, _Said]) -> list[str]:
    if _alike(said["v"], said["omega"]):
        return [f"Follows commands {said['v'].words}."]
    parts = [f"{channels[place]} commands {each.words}" for place, each in said.items() if each.words]
    return [f"Follows {', and '.join(parts)}."] if parts else []


def _arrives(channels: Channels, found: Found, responses: Mapping[str, StepResponse]) -> list[str]:
    """What has arrived of a step after a while, of channels that may go on with a slow mode after it."""
    parts = [
        f"{estimate_text(100.0 * soon[0], 100.0 * soon[1])} % of the {name} command"
        for place, name in channels.items()
        if _may_be_slow(found, place) and known(*(soon := responses[place].soon)) and soon[1] <= LEARNED
    ]
    verb = "has" if len(parts) == 1 else "have"
    return [f"{SOON:g} s after a step, {' and '.join(parts)} {verb} arrived."] if parts else []


def _said(found: Found, place: str, response: StepResponse) -> _Said:
    delay, lagging = found.get(f"delay_{place}"), f"time_constant_{place}" in found
    known_delay = None if delay is None or not delay.identified else (delay.value, delay.std)
    lag, slower = _lag(found, place)
    return _Said(
        known_delay,
        not lagging and known_delay is not None and known_delay[0] <= SAME * known_delay[1],
        lagging,
        lag,
        slower,
        response.risen if lagging and known(*response.risen) else None,
    )


def _lag(found: Found, place: str) -> tuple[tuple[float, float] | None, str]:
    """One time constant, and words for a slow mode; none where they are not what the drive does."""
    lag = found.get(f"time_constant_{place}")
    if lag is None or not lag.identified:
        return None, ""
    one = (lag.value, lag.std)
    slow, slow_time_constant = found.get(f"slow_fraction_{place}"), found.get(f"slow_time_constant_{place}")
    if slow is None or slow_time_constant is None:
        return one, ""
    if abs(slow.value) <= max(SAME * slow.std, LEAST_SLOW):
        return (None, "") if _may_be_slow(found, place) else (one, "")
    physical = 0.0 < slow.value < 1.0 and slow_time_constant.value > lag.value
    if not (physical and slow.identified and slow_time_constant.identified):
        return None, ""
    percent = estimate_text(100.0 * slow.value, 100.0 * slow.std)
    slowly = _seconds((slow_time_constant.value, slow_time_constant.std))
    return one, f", {percent} % of it with a slower one of {slowly}"


def _may_be_slow(found: Found, place: str) -> bool:
    """Whether there is a slow mode that is not known to be negligible."""
    slow = found.get(f"slow_fraction_{place}")
    none = slow is None or abs(slow.value) <= max(SAME * slow.std, LEAST_SLOW)
    return slow is not None and not (none and slow.std <= LARGEST_HIDDEN)


def _seconds(estimate: tuple[float, float]) -> str:
    return f"{estimate_text(*estimate)} s"


def _alike(first: _Said, second: _Said) -> bool:
    """Whether both channels say the same things with numbers that agree."""
    if not (first.words and second.words) or first.slower or second.slower:
        return False
    pairs = ((first.delay, second.delay), (first.lag, second.lag), (first.risen, second.risen))
    return all(
        (one is None and other is None) or (one is not None and other is not None and _agree(one, other))
        for one, other in pairs
    )


def _agree(first: tuple[float, float], second: tuple[float, float]) -> bool:
    return abs(first[0] - second[0]) <= SAME * hypot(first[1], second[1])
