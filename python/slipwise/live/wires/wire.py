# SPDX-License-Identifier: Apache-2.0
"""What carries ROS messages, bytes in and bytes out, by topic and type: its protocol, options and quality."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

from slipwise.errors import SettingsError

OnMessage = Callable[[bytes, float], None]  # a message, and when it arrived [s since 1970]
_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


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


@dataclass(frozen=True)
class Quality:
    """What a publisher offers or a subscription asks for; who asks for more than is offered hears nothing."""

    reliable: bool  # what was lost is sent again
    latched: bool  # who comes later gets the last message


def hearing_all(offered: Iterable[Quality], *, latched: bool) -> Quality:
    """Return the most that all publishers offer, and the usual where there is none.

    Args:
        offered: by the publishers known now.
        latched: whether the last message is wanted where publishers keep it.
    """
    known = list(offered)
    return Quality(
        reliable=all(quality.reliable for quality in known),
        latched=latched and all(quality.latched for quality in known),
    )


@dataclass(frozen=True)
class WireOptions:
    """How a node joins the graph of ROS."""

    node_name: str = "slipwise"
    namespace: str = "/"
    domain: int | None = None  # 0 to 232; None: what ROS_DOMAIN_ID says, or 0
    # Talk to other hosts, by multicast where the middleware does; otherwise to this one alone.
    network: bool = False

    def domain_number(self) -> int:
        """Return the domain, from the environment where none is given.

        Raises:
            SettingsError: it is no number of a domain.
        """
        text = str(self.domain) if self.domain is not None else os.environ.get("ROS_DOMAIN_ID", "") or "0"
        if not re.fullmatch("[0-9]{1,3}", text) or int(text) > 232:
            raise SettingsError(f'"{text}" is not a ROS domain', advice="domains are numbers from 0 to 232")
        return int(text)


def require_topic(name: str) -> str:
    """Return the name of a topic or service, which has to be absolute.

    Raises:
        SettingsError: it is not.
    """
    first, *parts = name.split("/")
    if first or not parts or not all(_PART.fullmatch(part) for part in parts):
        raise SettingsError(
            f'"{name}" is not the name of a topic', advice='write it with its slash, such as "/odom"'
        )
    return name
