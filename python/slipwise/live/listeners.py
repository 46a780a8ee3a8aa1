# SPDX-License-Identifier: Apache-2.0
"""Which topics have subscribers: messages without one need not be made."""

from __future__ import annotations

import time
from collections.abc import Callable

LOOK_EVERY = 0.5  # s between two looks; who comes meanwhile hears nothing until then


class Listeners:
    """Remembers for half a second whether a topic has subscribers; for one thread.

    Args:
        connections: how many subscriptions hear us on a topic.
        now: the time of a clock that is never set [s].
    """

    def __init__(
        self, connections: Callable[[str], int], *, now: Callable[[], float] = time.monotonic
    ) -> None:
        self._connections, self._now = connections, now
        self._looked: dict[str, tuple[float, bool]] = {}

    def on(self, topic: str) -> bool:
        """Return whether there was a subscriber at the last look."""
        now = self._now()
        at, subscribed = self._looked.get(topic, (now - LOOK_EVERY, False))
        if now >= at + LOOK_EVERY:
            subscribed = self._connections(topic) > 0
            self._looked[topic] = (now, subscribed)
        return subscribed
