# SPDX-License-Identifier: Apache-2.0
"""ROS 2 on Zenoh, for robots on rmw_zenoh, without an installation of ROS."""

from __future__ import annotations

import json
import threading
import time
from dataclasses import dataclass
from typing import Any

from slipwise.errors import SettingsError
from slipwise.live.wires.delivery import Delivery
from slipwise.live.wires.options import WireOptions
from slipwise.live.wires.ros_types import require_type
from slipwise.live.wires.silence import PATIENCE, PublisherSeen, SilenceWatch
from slipwise.live.wires.topic_names import require_topic
from slipwise.live.wires.wire import OnMessage, WireTopic
from slipwise.live.wires.zenoh_graph import (
    Endpoint,
    NodeTokens,
    attachment,
    data_key,
    gid_of,
    read_token,
)

_ASK_AGAIN = 2.0  # s for which a service is waited for


@dataclass
class _Publisher:
    entity: Any
    gid: bytes
    sent: int = 0


class ZenohWire:
    """A session that connects to the router, and listens on loopback alone, as nodes of rmw_zenoh do.

    Raises:
        SettingsError: Zenoh does not start with these options.
    """

    name = "zenoh"

    def __init__(self, options: WireOptions) -> None:
        import zenoh

        self._domain = options.domain_number()
        self._router = options.router
        try:
            self._session: Any = zenoh.open(_config(options))
        except zenoh.ZError as error:
            raise SettingsError(
                f"Zenoh does not start: {error}",
                where=options.router,
                advice='a router is named like "tcp/robot:7447"',
            ) from error
        self._opened = time.monotonic()
        self._router_said = False
        self._id = str(self._session.info.zid())
        self._node = NodeTokens(self._domain, self._id, options.node_name, options.namespace)
        self._lock = threading.RLock()
        self._silence = SilenceWatch()
        self._delivery = Delivery(self._silence)
        self._closed = self._delivery.closed
        self._publishers: dict[str, _Publisher] = {}
        self._wanted: dict[str, str] = {}
        self._keep: list[Any] = []  # tokens and subscriptions end with their objects
        self._endpoints: dict[str, Endpoint] = {}
        self._keep.append(self._session.liveliness().declare_token(self._node.of_node()))
        graph = f"@ros2_lv/{self._domain}/**"
        self._keep.append(self._session.liveliness().declare_subscriber(graph, self._on_token, history=True))

    def topics(self) -> list[WireTopic]:
        """Return what is published by others now."""
        counts: dict[tuple[str, str], int] = {}
        for endpoint in self._of_others():
            if endpoint.publishes:
                key = (endpoint.topic, endpoint.type)
                counts[key] = counts.get(key, 0) + 1
        return [WireTopic(topic, type_name, count) for (topic, type_name), count in sorted(counts.items())]

    def subscribe(self, topic: str, type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        """Deliver every message of a topic.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        from zenoh.ext import HistoryConfig, declare_advanced_subscriber

        key = data_key(self._domain, require_topic(topic), require_type(type_name), any_hash=True)
        with self._lock:
            self._delivery.require_open()
            self._silence.want(topic, type_name)
            self._wanted[topic] = type_name
            deliver = self._delivery.to(topic, on_message, lambda sample: bytes(sample.payload.to_bytes()))
            if latched:
                history = HistoryConfig(detect_late_publishers=True, max_samples=1)
                self._keep.append(declare_advanced_subscriber(self._session, key, deliver, history=history))
            else:
                self._keep.append(self._session.declare_subscriber(key, deliver))
            self._announce(topic, type_name, publishes=False, latched=latched)
            self._look()

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Announce a topic before its first message.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        from zenoh.ext import CacheConfig, declare_advanced_publisher

        key = data_key(self._domain, require_topic(topic), require_type(type_name))
        with self._lock:
            self._delivery.require_open()
            if topic in self._publishers:
                return
            if latched:
                cache = CacheConfig(max_samples=1)
                made: Any = declare_advanced_publisher(
                    self._session, key, cache=cache, publisher_detection=True
                )
            else:
                made = self._session.declare_publisher(key)
            token = self._announce(topic, type_name, publishes=True, latched=latched)
            self._publishers[topic] = _Publisher(made, gid_of(token))

    def publish(self, topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        """Send a message; the topic is announced at the first one, or by `advertise`.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        with self._lock:
            if topic not in self._publishers:
                self.advertise(topic, type_name, latched=latched)
            self._delivery.require_open()
            publisher = self._publishers[topic]
            publisher.sent += 1
            publisher.entity.put(payload, attachment=attachment(publisher.sent, publisher.gid))

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        """Call a service; None where nobody answers in time [s]. It is asked again every 2 s until then.

        Raises:
            SettingsError: there is no such service type, or no such name of a service.
        """
        import zenoh

        key = data_key(self._domain, require_topic(service), require_type(type_name), any_hash=True)
        until = time.monotonic() + timeout
        while (left := until - time.monotonic()) > 0:
            self._delivery.require_open()
            replies = self._session.get(
                key,
                payload=request,
                attachment=attachment(1, gid_of(f"{self._id}{time.time_ns()}")),
                target=zenoh.QueryTarget.ALL,
                consolidation=zenoh.ConsolidationMode.NONE,
                timeout=min(left, _ASK_AGAIN),
            )
            for reply in replies:
                if reply.ok is not None:
                    return bytes(reply.ok.payload.to_bytes())
            time.sleep(min(0.05, left))  # nobody serves it yet
        return None

    def connections(self, topic: str) -> int:
        """Return how many publishers we hear on a topic, and how many subscriptions hear us."""
        with self._lock:
            heard, publisher = topic in self._wanted, self._publishers.get(topic)
            matching = publisher is not None and publisher.entity.matching_status.matching
            found = [endpoint for endpoint in self._of_others() if endpoint.topic == topic]
        known: int = sum(heard if endpoint.publishes else matching for endpoint in found)
        return max(known, int(matching))  # who is no node of ROS announces no endpoint

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: no router, and topics on which nothing comes."""
        said = []
        with self._lock:
            if self._closed.is_set():
                return []
            self._look()
            late = time.monotonic() - self._opened >= PATIENCE and not self._router_said
            info = self._session.info
            if late and not (info.routers_zid() or info.peers_zid()):
                self._router_said = True
                said.append(
                    f"there is no Zenoh router at {self._router}: start rmw_zenohd there, or name another"
                )
        return said + self._silence.notices()

    def close(self) -> None:
        """Leave the graph; may be called twice."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
        self._session.close()  # without the lock, for which a callback may be waiting
        self._keep.clear()
        self._publishers.clear()

    def _announce(self, topic: str, type_name: str, *, publishes: bool, latched: bool) -> str:
        number = len(self._keep) + len(self._publishers) + 1
        token = self._node.of_endpoint(number, topic, type_name, publishes=publishes, latched=latched)
        self._keep.append(self._session.liveliness().declare_token(token))
        return token

    def _on_token(self, sample: Any) -> None:
        import zenoh

        token = str(sample.key_expr)
        endpoint = read_token(token)
        if endpoint is None:
            return
        with self._lock:
            if sample.kind == zenoh.SampleKind.PUT:
                self._endpoints[token] = endpoint
            else:
                self._endpoints.pop(token, None)

    def _look(self) -> None:
        others = [endpoint for endpoint in self._of_others() if endpoint.publishes]
        for topic in self._wanted:
            seen = [
                PublisherSeen("Zenoh", endpoint.type, True) for endpoint in others if endpoint.topic == topic
            ]
            self._silence.seen(topic, seen)

    def _of_others(self) -> list[Endpoint]:
        with self._lock:
            return [endpoint for endpoint in self._endpoints.values() if endpoint.session != self._id]


def _config(options: WireOptions) -> Any:
    import zenoh

    config = zenoh.Config()
    for key, value in (
        ("mode", "peer"),
        ("connect/endpoints", [options.router]),
        ("connect/exit_on_failure", False),
        ("connect/timeout_ms", -1),
        ("listen/endpoints", ["tcp/127.0.0.1:0"]),
        ("scouting/multicast/enabled", options.network),
        ("scouting/gossip/enabled", True),
        ("timestamping/enabled", True),  # what is kept for others needs times
    ):
        config.insert_json5(key, json.dumps(value))
    return config
