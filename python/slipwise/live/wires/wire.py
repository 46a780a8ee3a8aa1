# SPDX-License-Identifier: Apache-2.0
"""The protocol of everything that carries ROS messages: bytes in, bytes out, by topic and type."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

OnMessage = Callable[[bytes, float], None]  # a message, and when it arrived [s since 1970]


@dataclass(frozen=True)
class WireTopic:
    """A topic with a publisher."""

    name: str  # with its slash, such as "/odom"
    type: str  # such as "nav_msgs/msg/Odometry"
    publishers: int


class RosWire(Protocol):
    """Messages are CDR with its header of 4 bytes (rosbags' `serialize_cdr`).

    Callbacks come from threads of the wire. Names of topics and services are absolute ("/odom").
    """

    @property
    def name(self) -> str:
        """What carries the messages: "rclpy" or "cyclonedds"."""

    def topics(self) -> list[WireTopic]:
        """Return what is published by others now."""

    def subscribe(self, topic: str, type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        """Deliver every message of a topic.

        Raises:
            SlipwiseError: there is no such type, or the wire refuses.
        """

    def publish(self, topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        """Send a message; the topic is announced at the first one, or by `advertise`."""

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Announce a topic before its first message."""

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        """Call a service, such as one of "rcl_interfaces/srv/SetParameters"; None: no answer in time [s]."""

    def connections(self, topic: str) -> int:
        """Return how many publishers we hear on a topic, and how many subscriptions hear us."""

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: topics on which nothing comes, and the ways out."""

    def close(self) -> None:
        """Leave the graph; may be called twice."""
