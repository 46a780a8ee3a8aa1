# SPDX-License-Identifier: Apache-2.0
"""Finds the topics of a running robot: the ones given, or guessed as for a bag, and said."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from slipwise.errors import LogError
from slipwise.live.wires.wire import RosWire
from slipwise.logs.messages import TF
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import NONE, Topic
from slipwise.logs.topics import NOTHING_YET, Roles, choose_topics, weigh_topics

LOOK_EVERY = 0.25  # s
SETTLED = 1.5  # s for which what is guessed must stay the same: discovery takes its time
SAY_AFTER = 3.0  # s without the topics, after which it is said what is waited for


@dataclass
class _Seen:
    names: frozenset[str] = frozenset()
    since: float = 0.0


def find_roles(
    wire: RosWire,
    options: LogOptions,
    say: Callable[[str], None],
    *,
    own: str = "",
    seconds: float | None = None,
) -> Roles:
    """Wait until the robot's topics are there, and choose among them.

    Args:
        wire: shows what is published.
        options: topics that are given; the others are guessed.
        say: is told what is waited for.
        own: the name below which the node publishes; such topics are never chosen.
        seconds: how long to wait; None: for ever.

    Raises:
        LogError: a given topic has the wrong type, the guess is unclear, or the time is over.
    """
    begin, seen, said = time.monotonic(), _Seen(), False
    while True:
        topics = [
            Topic(topic.name, topic.type, 1)
            for topic in wire.topics()
            if topic.type != TF and not (own and topic.name.startswith(f"{own}/"))
        ]
        now = time.monotonic()
        names = frozenset(topic.name for topic in topics)
        if names != seen.names:
            seen = _Seen(names, now)
        missing = _missing(topics, options)
        if not missing and (now > seen.since + SETTLED or _all_given(options)):
            return choose_topics(topics, options)
        if seconds is not None and now > begin + seconds:
            if missing:
                raise LogError(f"the robot is silent: no {missing}", advice=_advice(names))
            return choose_topics(topics, options)
        if missing and not said and now > begin + SAY_AFTER:
            said = True
            say(f"waiting for {missing}; there is {', '.join(sorted(names)[:8]) or 'no topic at all'}")
        time.sleep(LOOK_EVERY)


def _all_given(options: LogOptions) -> bool:
    return options.pose_topic is not None and bool(options.command_topic or options.wheel_topic)


def _missing(topics: list[Topic], options: LogOptions) -> str:
    """Name what is not there yet; empty where a choice can be made."""
    names = {topic.name for topic in topics}
    given = (options.pose_topic, options.command_topic, options.wheel_topic)
    absent = [name for name in given if name is not None and name != NONE and name not in names]
    if absent:
        return " and ".join(absent)
    problem = weigh_topics(topics, options).problem
    if problem is None or not problem.what.startswith(NOTHING_YET):
        return ""
    return _kinds(topics)


def _kinds(topics: list[Topic]) -> str:
    return "pose topic and a command or wheel topic beside it" if topics else "topics of a robot"


def _advice(names: frozenset[str]) -> str:
    there = f"there is {', '.join(sorted(names)[:12])}" if names else "no publisher was found at all"
    return f"{there}; check --domain and --transport, or name the topics"
