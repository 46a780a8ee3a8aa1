# SPDX-License-Identifier: Apache-2.0
"""Which topic takes one role, and why the others do not; nothing is raised here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from slipwise.errors import LogError
from slipwise.logs.options import LogOptions
from slipwise.logs.topic_names import Names, score_of

NONE = "none"  # given in place of a topic: the role stays empty


@dataclass(frozen=True)
class Topic:
    """A topic of a bag."""

    name: str
    type: str
    count: int
    rate: float = float("nan")  # [Hz] messages over the duration of the bag; NaN where that is not known


@dataclass(frozen=True)
class RoleChoice:
    """The topic of a role, None where there is none."""

    topic: Topic | None = None
    why: str = ""  # it was chosen
    rejected: Mapping[str, str] = field(default_factory=dict)  # why others were not, by name
    problem: LogError | None = None  # why there can be no choice


@dataclass(frozen=True)
class Role:
    """What a role asks of a topic."""

    name: str  # "pose", "command", "wheel", "imu"
    kinds: tuple[str, ...]
    names: Names

    @property
    def option(self) -> str:
        """The option that names the topic."""
        return f"--{self.name}-topic"

    def given(self, options: LogOptions) -> str | None:
        """Return the topic that is named for it."""
        name: str | None = getattr(options, f"{self.name}_topic")
        return name


def choose(live: Mapping[str, Topic], role: Role, given: str | None) -> RoleChoice:
    """Take the topic that is given, or the one whose name and type fit best.

    Args:
        live: topics that have messages, by name.
        role: what is looked for.
        given: the topic's name, "none" for no topic at all, or None to guess.
    """
    candidates = [topic for topic in live.values() if topic.type in role.kinds]
    if given is not None:
        return _given(live, candidates, role, given)
    rejected: dict[str, str] = {}
    scored: list[tuple[int, Topic]] = []
    for topic in candidates:
        score, why = score_of(topic.name, topic.type, role.names)
        if score < 0:
            rejected[topic.name] = why
        else:
            scored.append((score, topic))
    if not scored:
        return RoleChoice(rejected=rejected)
    best = max(score for score, _ in scored)
    winners = [topic for score, topic in scored if score == best]
    if len(winners) > 1:
        return _undecided(role, winners, scored, rejected)
    rejected |= {
        topic.name: f"the name {winners[0].name} fits better" for score, topic in scored if score < best
    }
    why = "only candidate" if len(scored) == 1 else "best name"
    return RoleChoice(winners[0], why, rejected)


def listing(live: Mapping[str, Topic]) -> str:
    """Say which topics a bag has, in words."""
    if not live:
        return "the bag has no messages"
    shown = [
        f"{topic.name} ({topic.type.split('/')[-1]})" for topic in sorted(live.values(), key=lambda t: t.name)
    ]
    return "the bag has " + ", ".join(shown[:15]) + (", ..." if len(shown) > 15 else "")


def _given(live: Mapping[str, Topic], candidates: list[Topic], role: Role, given: str) -> RoleChoice:
    topic = live.get(given) or live.get(f"/{given}")
    others = {t.name: f"{role.option} is {given}" for t in candidates if t is not topic}
    if topic is None and given == NONE:
        return RoleChoice(rejected=others)
    if topic is None:
        problem = LogError(f"{role.option} {given} is not in the bag, or empty", advice=listing(live))
        return RoleChoice(rejected=others, problem=problem)
    if topic.type not in role.kinds:
        expected = ", ".join(kind.split("/")[-1] for kind in role.kinds)
        problem = LogError(f"{role.option} {given} is a {topic.type}", advice=f"it must be one of {expected}")
        return RoleChoice(rejected=others, problem=problem)
    return RoleChoice(topic, f"named by {role.option}", others)


def _undecided(
    role: Role, winners: list[Topic], scored: list[tuple[int, Topic]], rejected: dict[str, str]
) -> RoleChoice:
    shown = ", ".join(f"{topic.name} ({topic.count} messages)" for topic in winners)
    problem = LogError(
        f"several topics could be the {role.name}", advice=f"give {role.option} one of {shown}"
    )
    why = {topic.name: f"one of several candidates: choose with {role.option}" for topic in winners}
    lesser = {topic.name: "others have better names" for _, topic in scored if topic not in winners}
    return RoleChoice(rejected=rejected | lesser | why, problem=problem)
