# SPDX-License-Identifier: Apache-2.0
"""ROS 1 Noetic, where rospy can be imported; its bytes are turned into those of ROS 2 and back."""

from __future__ import annotations

import os
import socket
import threading
import time
from importlib import import_module
from typing import TYPE_CHECKING, Any
from urllib.parse import urlparse

from slipwise.errors import SettingsError
from slipwise.live.wires.delivery import Delivery
from slipwise.live.wires.options import WireOptions
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.silence import PublisherSeen, SilenceWatch
from slipwise.live.wires.topic_names import require_topic
from slipwise.live.wires.wire import OnMessage, WireTopic

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore


class RospyWire:
    """The one node of rospy that a process can have; types are named as in ROS 2 ("nav_msgs/msg/Odometry").

    Raises:
        SettingsError: there is no master, or the process has a node already.
    """

    name = "rospy"

    def __init__(self, options: WireOptions) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._rospy: Any = import_module("rospy")
        # They give names and sums; bytes are turned by the types of ROS 2, whose header has no counter.
        self._types: Typestore = get_typestore(Stores.ROS1_NOETIC)
        _require_master()
        if not options.network:
            os.environ.setdefault("ROS_IP", "127.0.0.1")
        os.environ.setdefault("ROS_NAMESPACE", options.namespace)
        try:
            self._rospy.init_node(options.node_name, disable_signals=True)
        except self._rospy.exceptions.ROSException as error:
            raise SettingsError(f"rospy does not start: {error}", advice="a process has one node") from error
        self._publishers: dict[str, Any] = {}
        self._subscribers: dict[str, list[Any]] = {}
        self._silence = SilenceWatch()
        self._lock = threading.RLock()
        self._delivery = Delivery(self._silence)
        self._closed = self._delivery.closed

    def topics(self) -> list[WireTopic]:
        """Return what is published by others now."""
        master = self._rospy.get_master()
        types = dict(master.getTopicTypes()[2])
        own = self._rospy.get_name()
        found = []
        for topic, nodes in master.getSystemState()[2][0]:
            others = [node for node in nodes if node != own]
            if others and topic in types:
                found.append(WireTopic(topic, _ros2_name(types[topic]), len(others)))
        return found

    def subscribe(
        self,
        topic: str,
        type_name: str,
        on_message: OnMessage,
        *,
        latched: bool = False,  # noqa: ARG002
    ) -> None:
        """Deliver every message of a topic; ROS 1 gives the latched one by itself.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        require_topic(topic)
        self._require_type(type_name)

        def to_bytes(message: Any) -> bytes:
            return bytes(ros_types().ros1_to_cdr(message._buff, type_name))  # noqa: SLF001

        deliver = self._delivery.to(topic, on_message, to_bytes)
        with self._lock:
            self._delivery.require_open()
            self._silence.want(topic, type_name)
            made = self._rospy.Subscriber(
                topic, self._rospy.AnyMsg, deliver, queue_size=1000, tcp_nodelay=True
            )
            self._subscribers.setdefault(topic, []).append(made)

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Announce a topic before its first message.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        self._require_type(type_name)
        with self._lock:
            self._delivery.require_open()
            if require_topic(topic) not in self._publishers:
                made = self._rospy.Publisher(
                    topic, self._class_of(type_name), latch=latched, queue_size=100, tcp_nodelay=True
                )
                self._publishers[topic] = made

    def publish(self, topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        """Send a message; the topic is announced at the first one, or by `advertise`.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        with self._lock:
            self.advertise(topic, type_name, latched=latched)
            publisher = self._publishers[topic]
        message = self._rospy.AnyMsg()
        message._buff = bytes(ros_types().cdr_to_ros1(payload, type_name))  # noqa: SLF001
        publisher.publish(message)

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:  # noqa: ARG002
        """Return None: services of ROS 1 are others than those of ROS 2, such as dynamic_reconfigure."""
        require_topic(service)
        return None

    def connections(self, topic: str) -> int:
        """Return how many publishers we hear on a topic, and how many subscriptions hear us."""
        with self._lock:
            heard = [subscriber.get_num_connections() for subscriber in self._subscribers.get(topic, [])]
            publisher = self._publishers.get(topic)
            return max(heard, default=0) + (publisher.get_num_connections() if publisher is not None else 0)

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: topics on which nothing comes."""
        with self._lock:
            if self._closed.is_set():
                return []
            found = self.topics()
            for topic in self._subscribers:
                connected = self.connections(topic) > 0
                seen = [PublisherSeen("ROS 1", one.type, connected) for one in found if one.name == topic]
                self._silence.seen(topic, seen)
        return self._silence.notices()

    def close(self) -> None:
        """Leave the graph; may be called twice. The process can have no other node of rospy after it."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
        self._rospy.signal_shutdown("slipwise ends")

    def _class_of(self, type_name: str) -> Any:
        """Return a class of message that announces a type and carries bytes."""
        definition, digest = self._types.generate_msgdef(type_name)
        package, _, name = type_name.split("/")
        description = {"_type": f"{package}/{name}", "_md5sum": digest, "_full_text": definition}
        return type(f"{name}Bytes", (self._rospy.AnyMsg,), {**description, "_has_header": False})

    def _require_type(self, type_name: str) -> None:
        if type_name not in self._types.fielddefs or type_name not in ros_types().fielddefs:
            raise SettingsError(
                f'there is no message type "{type_name}" in ROS 1',
                advice='a type is named like "nav_msgs/msg/Odometry"',
            )


def _ros2_name(type_name: str) -> str:
    package, _, name = type_name.partition("/")
    return f"{package}/msg/{name}"


def _require_master(patience: float = 1.0) -> None:
    """Raise SettingsError unless a master answers at ROS_MASTER_URI; rospy itself would wait for ever."""
    uri = os.environ.get("ROS_MASTER_URI", "http://localhost:11311")
    address = urlparse(uri)
    until = time.monotonic() + patience
    while True:
        try:
            socket.create_connection(
                (address.hostname or "localhost", address.port or 11311), timeout=1.0
            ).close()
            return
        except OSError as error:
            if time.monotonic() >= until:
                raise SettingsError(
                    "no ROS 1 master answers", where=uri, advice="start roscore, or set ROS_MASTER_URI"
                ) from error
            time.sleep(0.1)
