# SPDX-License-Identifier: Apache-2.0
"""ROS 2 by its own Python client, where that can be imported: any middleware that the robot has."""

from __future__ import annotations

import logging
import os
import threading
import time
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from slipwise.errors import SettingsError
from slipwise.live.wires.delivery import Delivery
from slipwise.live.wires.rclpy_inbox import left_to_us, take_all
from slipwise.live.wires.silence import PublisherSeen, SilenceWatch
from slipwise.live.wires.wire import OnMessage, Quality, WireOptions, WireTopic, hearing_all, require_topic

_log = logging.getLogger(__name__)
_DEPTH = 1000  # messages kept for who is busy, on either side
_ROUND = 0.005  # s between two rounds of taking what waits
_LOOK = 0.25  # s between looks at who publishes


@dataclass
class _Subscription:
    topic: str
    type_name: str
    deliver: OnMessage
    latched: bool
    quality: Quality
    entity: Any
    publishers: int = -1  # at the last look


class RclpyWire:
    """A node in a context of its own, whose subscriptions give bytes; or a node of others.

    A thread takes what waits in the subscriptions, in rounds. All else, such as services, is the executor's.

    Signals stay with the program. Where neither the options nor ROS_AUTOMATIC_DISCOVERY_RANGE ask for the
    network, that variable is set to this host alone.

    Args:
        options: of the node.
        node: of others, whose executor spins it; it stays theirs, and is left as it was.

    Raises:
        SettingsError: rclpy does not start with these options.
    """

    name = "rclpy"

    def __init__(self, options: WireOptions, node: Any = None) -> None:
        rclpy: Any = import_module("rclpy")
        self._node: Any = _own_node(options) if node is None else node
        self._middleware = str(rclpy.get_rmw_implementation_identifier())
        self._publishers: dict[str, Any] = {}
        self._clients: dict[str, Any] = {}
        self._subscriptions: list[_Subscription] = []
        self._silence = SilenceWatch()
        self._lock = threading.RLock()
        self._delivery = Delivery(self._silence)
        self._closed = self._delivery.closed
        self._group: Any = left_to_us()
        self._executor: Any = None
        self._threads = [threading.Thread(target=self._receive, name="slipwise-rclpy", daemon=True)]
        if node is None:
            executors: Any = import_module("rclpy.executors")
            self._executor = executors.SingleThreadedExecutor(context=self._node.context)
            self._executor.add_node(self._node)
            self._threads.append(threading.Thread(target=self._spin, name="slipwise-spin", daemon=True))
        for thread in self._threads:
            thread.start()

    def topics(self) -> list[WireTopic]:
        """Return what is published by others now.

        Raises:
            SettingsError: the wire is closed.
        """
        self._delivery.require_open()
        own = self._node.get_name(), self._node.get_namespace()
        found = []
        for topic, types in self._node.get_topic_names_and_types():
            publishers = self._node.get_publishers_info_by_topic(topic)
            for type_name in types:
                others = [
                    publisher
                    for publisher in publishers
                    if publisher.topic_type == type_name
                    and (publisher.node_name, publisher.node_namespace) != own
                ]
                if others:
                    found.append(WireTopic(topic, type_name, len(others)))
        return found

    def subscribe(self, topic: str, type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        """Deliver every message of a topic.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        require_topic(topic)
        with self._lock:
            self._delivery.require_open()
            quality = hearing_all(self._offered(topic), latched=latched)
            deliver = self._delivery.to(topic, on_message)
            made = _Subscription(topic, type_name, deliver, latched, quality, None)
            made.entity = self._make_subscription(made)
            self._silence.want(topic, type_name)
            self._subscriptions.append(made)

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Announce a topic before its first message.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        with self._lock:
            self._delivery.require_open()
            if require_topic(topic) not in self._publishers:
                quality = _profile(Quality(reliable=True, latched=latched), depth=1 if latched else _DEPTH)
                self._publishers[topic] = self._node.create_publisher(_class_of(type_name), topic, quality)

    def publish(self, topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        """Send a message; the topic is announced at the first one, or by `advertise`.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        with self._lock:
            self.advertise(topic, type_name, latched=latched)
            self._publishers[topic].publish(payload)

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        """Call a service; None where no answer comes in time [s]. A callback of a topic must not call.

        Raises:
            SettingsError: there is no such service type, or no such name of a service.
        """
        serialization: Any = import_module("rclpy.serialization")
        with self._lock:
            self._delivery.require_open()
            kind = _class_of(type_name)
            if require_topic(service) not in self._clients:
                self._clients[service] = self._node.create_client(kind, service)
            client = self._clients[service]
        if not client.wait_for_service(timeout_sec=timeout):
            return None
        answered = threading.Event()
        future = client.call_async(serialization.deserialize_message(request, kind.Request))
        future.add_done_callback(lambda _: answered.set())
        if not answered.wait(timeout):
            client.remove_pending_request(future)
            return None
        return bytes(serialization.serialize_message(future.result()))

    def connections(self, topic: str) -> int:
        """Return how many publishers we hear on a topic, and how many subscriptions hear us."""
        with self._lock:
            publishers = [
                made.entity.get_publisher_count() for made in self._subscriptions if made.topic == topic
            ]
            publisher = self._publishers.get(topic)
            return max(publishers, default=0) + (
                publisher.get_subscription_count() if publisher is not None else 0
            )

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: topics on which nothing comes, and the ways out."""
        return self._silence.notices()

    def close(self) -> None:
        """Leave the graph; may be called twice."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
        if self._executor is not None:
            self._executor.shutdown()
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join()
        if self._executor is None:
            self._leave_node()
            return
        self._node.destroy_node()
        self._node.context.try_shutdown()

    def _leave_node(self) -> None:
        """Take away what was made on a node of others."""
        node = self._node
        for made in self._subscriptions:
            node.destroy_subscription(made.entity)
        for publisher in self._publishers.values():
            node.destroy_publisher(publisher)
        for client in self._clients.values():
            node.destroy_client(client)

    def _spin(self) -> None:
        external: Any = import_module("rclpy.executors").ExternalShutdownException
        while not self._closed.is_set():
            try:
                self._executor.spin()
            except external:
                return
            except Exception:
                _log.exception("rclpy stumbled, and goes on")

    def _receive(self) -> None:
        look = 0.0
        while not self._closed.is_set() and self._node.context.ok():
            try:
                with self._lock:
                    waiting = take_all([(made.entity, made.deliver) for made in self._subscriptions])
                for arrived, message, deliver in waiting:
                    deliver(message, arrived)
                if time.monotonic() >= look:
                    look = time.monotonic() + _LOOK
                    self._look()
            except Exception:
                if self._node.context.ok():
                    _log.exception("messages cannot be taken")
                time.sleep(_LOOK)
            time.sleep(_ROUND)

    def _look(self) -> None:
        """Subscribe again where a publisher offers less than is asked for, and note who publishes."""
        with self._lock:
            if self._closed.is_set():
                return
            for made in self._subscriptions:
                publishers = self._node.count_publishers(made.topic)
                connected = made.entity.get_publisher_count()
                if publishers == connected == made.publishers and self._silence.has_message(made.topic):
                    continue  # nobody came or went; to ask for each takes ten times as long
                made.publishers = publishers
                quality = hearing_all(self._offered(made.topic), latched=made.latched)
                if quality != made.quality:
                    made.quality = quality
                    before, made.entity = made.entity, self._make_subscription(made)
                    self._node.destroy_subscription(before)
                offering = self._node.get_publishers_info_by_topic(made.topic)
                matched = made.entity.get_publisher_count() > 0
                seen = [PublisherSeen(self._middleware, found.topic_type, matched) for found in offering]
                self._silence.seen(made.topic, seen)

    def _make_subscription(self, made: _Subscription) -> Any:
        profile = _profile(made.quality, depth=_DEPTH)
        return self._node.create_subscription(
            _class_of(made.type_name), made.topic, made.deliver, profile, callback_group=self._group, raw=True
        )

    def _offered(self, topic: str) -> list[Quality]:
        policies: Any = import_module("rclpy.qos")
        return [
            Quality(
                reliable=found.qos_profile.reliability != policies.ReliabilityPolicy.BEST_EFFORT,
                latched=found.qos_profile.durability == policies.DurabilityPolicy.TRANSIENT_LOCAL,
            )
            for found in self._node.get_publishers_info_by_topic(topic)
        ]


def _own_node(options: WireOptions) -> Any:
    """Return a node in a context of its own.

    Raises:
        SettingsError: rclpy does not start with these options.
    """
    rclpy: Any = import_module("rclpy")
    signals: Any = import_module("rclpy.signals")
    if not options.network:
        os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    context: Any = import_module("rclpy.context").Context()
    try:
        rclpy.init(
            context=context,
            domain_id=options.domain_number(),
            signal_handler_options=signals.SignalHandlerOptions.NO,
        )
        return rclpy.create_node(
            options.node_name, context=context, namespace=options.namespace, use_global_arguments=False
        )
    except (RuntimeError, ValueError) as error:
        context.try_shutdown()
        raise SettingsError(f"rclpy does not start: {error}", advice="look at the node's name") from error


def _class_of(type_name: str) -> Any:
    """Return the class of a message or service such as "nav_msgs/msg/Odometry".

    Raises:
        SettingsError: this ROS does not have it.
    """
    package, _, rest = type_name.partition("/")
    kind, _, name = rest.partition("/")
    try:
        return getattr(import_module(f"{package}.{kind}"), name)
    except (ImportError, AttributeError) as error:
        raise SettingsError(
            f'there is no message type "{type_name}" in this ROS',
            advice=f"look for a typing error, or install the ROS package {package}",
        ) from error


def _profile(quality: Quality, *, depth: int) -> Any:
    qos: Any = import_module("rclpy.qos")
    reliability, durability = qos.ReliabilityPolicy, qos.DurabilityPolicy
    return qos.QoSProfile(
        depth=depth,
        reliability=reliability.RELIABLE if quality.reliable else reliability.BEST_EFFORT,
        durability=durability.TRANSIENT_LOCAL if quality.latched else durability.VOLATILE,
    )
