# SPDX-License-Identifier: Apache-2.0
"""Says once why nothing comes on a topic that has a publisher."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

#: Seconds after which silence is said.
PATIENCE = 3.0

_WAYS_OUT = (
    "ways out: start slipwise where ROS 2 is sourced, so that rclpy is used; or set "
    "fastdds.type_propagation=disabled in the robot's Fast DDS profile"
)


@dataclass(frozen=True)
class PublisherSeen:
    """A publisher of a wanted topic, as discovery shows it."""

    vendor: str  # of its middleware, such as "eProsima Fast DDS"
    type: str  # such as "nav_msgs/msg/Odometry"
    matched: bool  # whether the middleware connected it with us


@dataclass
class _Wanted:
    type: str
    received: bool = False
    since: float | None = None  # when a publisher was first seen
    publisher: PublisherSeen | None = None
    said: bool = False


class SilenceWatch:
    """Keeps, for each wanted topic, whether a message came and who publishes it; any thread may use it."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._topics: dict[str, _Wanted] = {}
        self._lock = threading.Lock()

    def want(self, topic: str, type_name: str) -> None:
        """Begin to watch a topic."""
        with self._lock:
            self._topics.setdefault(topic, _Wanted(type_name))

    def received(self, topic: str) -> None:
        """Take note that a message came."""
        wanted = self._topics.get(topic)
        if wanted is not None:
            wanted.received = True

    def has_message(self, topic: str) -> bool:
        """Return whether a message came, after which who publishes is of no concern."""
        wanted = self._topics.get(topic)
        return wanted is not None and wanted.received

    def seen(self, topic: str, publishers: list[PublisherSeen]) -> None:
        """Take note of who publishes on a topic now."""
        with self._lock:
            wanted = self._topics.get(topic)
            if wanted is None:
                return
            # The one to speak of is the one that is least likely to arrive.
            order = sorted(publishers, key=lambda seen: (seen.matched, seen.type == wanted.type))
            wanted.publisher = order[0] if order else None
            if wanted.publisher is None:
                wanted.since = None
            elif wanted.since is None:
                wanted.since = self._now()

    def notices(self) -> list[str]:
        """Return what is to be said, once for each topic."""
        said = []
        with self._lock:
            for topic, wanted in self._topics.items():
                publisher, since = wanted.publisher, wanted.since
                if publisher is None or since is None or wanted.received or wanted.said:
                    continue
                if self._now() - since >= PATIENCE:
                    wanted.said = True
                    said.append(_notice(topic, wanted.type, publisher))
        return said


def _notice(topic: str, type_name: str, publisher: PublisherSeen) -> str:
    start = f"nothing has come on {topic} for {PATIENCE:g} s, though {publisher.vendor} publishes it"
    if publisher.type != type_name:
        return f"{start}: as {publisher.type}, not as {type_name}"
    if publisher.matched:
        return f"{start}: the connection stands, it may have nothing to tell yet"
    return f"{start}: its description of {publisher.type} or its quality of service was refused; {_WAYS_OUT}"
