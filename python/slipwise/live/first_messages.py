# SPDX-License-Identifier: Apache-2.0
"""Hears a robot's topics before it is known how they are read, and keeps what came for the learner."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping
from functools import partial

from slipwise.live.wires.wire import OnMessage, RosWire
from slipwise.logs.role_choice import Topic


class FirstMessages:
    """Keeps messages until somebody takes them over, in the order in which they came.

    Args:
        wire: brings them.
        topics: that are heard, each once.

    Raises:
        SlipwiseError: the wire refuses a topic.
    """

    def __init__(self, wire: RosWire, topics: Iterable[Topic] = ()) -> None:
        self._changed = threading.Condition()
        self._kept: list[tuple[str, bytes, float]] = []
        self._takers: Mapping[str, OnMessage] | None = None
        kinds = {topic.name: topic.type for topic in topics}
        self.topics = frozenset(kinds)
        for name, kind in kinds.items():
            wire.subscribe(name, kind, partial(self._hear, name))

    def of(self, topic: str, count: int, within: float) -> list[bytes] | None:
        """Return the first messages of a topic; None where the next does not come in time [s]."""
        with self._changed:
            while len(found := self._payloads(topic)) < count:
                if not self._changed.wait_for(partial(self._has_more, topic, len(found)), within):
                    return None
            return found[:count]

    def hand_over(self, takers: Mapping[str, OnMessage]) -> None:
        """Give what was kept, and what comes from now on, to who takes it by the topic's name."""
        with self._changed:
            for topic, payload, arrived in self._kept:
                if topic in takers:
                    takers[topic](payload, arrived)
            self._kept.clear()
            self._takers = takers

    def _payloads(self, topic: str) -> list[bytes]:
        return [payload for name, payload, _ in self._kept if name == topic]

    def _has_more(self, topic: str, than: int) -> bool:
        return len(self._payloads(topic)) > than

    def _hear(self, topic: str, payload: bytes, arrived: float) -> None:
        with self._changed:
            if self._takers is None:
                self._kept.append((topic, payload, arrived))
                self._changed.notify_all()
                return
        if topic in self._takers:
            self._takers[topic](payload, arrived)
