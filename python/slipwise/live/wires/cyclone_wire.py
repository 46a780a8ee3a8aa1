# SPDX-License-Identifier: Apache-2.0
"""ROS 2 without an installation of ROS: a node on Cyclone DDS whose messages stay bytes."""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import dataclass
from typing import Any

from slipwise.errors import SettingsError
from slipwise.live.wires.cyclone_bytes import take_cdr, write_cdr
from slipwise.live.wires.cyclone_config import close_domain, open_domain
from slipwise.live.wires.cyclone_discovery import CycloneDiscovery, Publication
from slipwise.live.wires.cyclone_graph import PARTICIPANT_DATA, CycloneGraph, endpoint_data
from slipwise.live.wires.cyclone_service import CycloneService
from slipwise.live.wires.cyclone_types import cyclone_type
from slipwise.live.wires.delivery import Delivery
from slipwise.live.wires.silence import PublisherSeen, SilenceWatch
from slipwise.live.wires.wire import OnMessage, Quality, WireOptions, WireTopic, hearing_all, require_topic

_log = logging.getLogger(__name__)
_DEPTH = 1000  # messages kept for who is busy, on either side: 10 s at 100 Hz
_WAIT = 200_000_000  # ns
_PAUSE = 0.005  # s after messages were taken: a wake-up for each would cost more than to read it
_LOOK = 0.25  # s between looks for who publishes, and for silent topics
DISCOVERY = 5.0  # s after it was opened until a wire knows all others; mostly 1 s


@dataclass
class _Subscription:
    topic: str
    type_name: str
    deliver: OnMessage
    latched: bool
    quality: Quality
    reader: Any
    condition: Any


class CycloneWire:
    """One participant, one thread that waits for messages and hands them over.

    Raises:
        SettingsError: Cyclone DDS does not start with these options.
    """

    name = "cyclonedds"

    def __init__(self, options: WireOptions) -> None:
        from cyclonedds.core import DDSException, GuardCondition, Policy, Qos, WaitSet
        from cyclonedds.domain import DomainParticipant

        self._domain = options.domain_number()
        open_domain(self._domain, network=options.network)
        try:
            self._participant: Any = DomainParticipant(self._domain, Qos(Policy.Userdata(PARTICIPANT_DATA)))
        except DDSException as error:
            close_domain(self._domain)
            raise SettingsError(
                f"Cyclone DDS does not start: {error}", where=f"domain {self._domain}"
            ) from error
        self._graph: Any = CycloneGraph(self._participant, options.node_name, options.namespace)
        self._discovery: Any = CycloneDiscovery(self._participant)
        self._topics: dict[tuple[str, str], Any] = {}
        self._writers: dict[str, Any] = {}
        self._services: dict[str, CycloneService] = {}
        self._subscriptions: list[_Subscription] = []
        self._silence = SilenceWatch()
        self._lock = threading.RLock()
        self._delivery = Delivery(self._silence)
        self._closed = self._delivery.closed
        self._opened = time.monotonic()
        self._wake: Any = GuardCondition(self._participant)
        self._waitset: Any = WaitSet(self._participant)
        self._waitset.attach(self._wake)
        self._waitset.attach(self._discovery.condition)
        self._thread = threading.Thread(target=self._receive, name="slipwise-cyclonedds", daemon=True)
        self._thread.start()

    def topics(self) -> list[WireTopic]:
        """Return what is published by others now."""
        counts: dict[tuple[str, str], int] = {}
        with self._lock:
            self._discovery.refresh()
            for publication in self._of_others():
                if publication.topic.startswith("rt/"):
                    key = (publication.topic.removeprefix("rt"), publication.type)
                    counts[key] = counts.get(key, 0) + 1
        return [WireTopic(topic, type_name, count) for (topic, type_name), count in sorted(counts.items())]

    def subscribe(self, topic: str, type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        """Deliver every message of a topic.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        require_topic(topic)
        with self._lock:
            self._delivery.require_open()
            quality = hearing_all(self._offered(topic), latched=latched)
            reader, condition = self._make_reader(topic, type_name, quality)
            self._silence.want(topic, type_name)
            deliver = self._delivery.to(topic, on_message)
            made = _Subscription(topic, type_name, deliver, latched, quality, reader, condition)
            self._subscriptions = [*self._subscriptions, made]

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Announce a topic before its first message.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
        """
        from cyclonedds.pub import DataWriter

        with self._lock:
            self._delivery.require_open()
            if require_topic(topic) not in self._writers:
                qos = _qos(Quality(reliable=True, latched=latched), type_name, depth=1 if latched else _DEPTH)
                writer = DataWriter(self._participant, self._topic(f"rt{topic}", type_name), qos=qos)
                self._writers[topic] = writer
                self._graph.add(writer=writer)

    def publish(self, topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        """Send a message; the topic is announced at the first one, or by `advertise`.

        Raises:
            SettingsError: there is no such type, or no such name of a topic.
            OSError: Cyclone refuses the bytes.
        """
        writer = self._writers.get(topic)
        if writer is None:
            self.advertise(topic, type_name, latched=latched)
            writer = self._writers[topic]
        write_cdr(writer, payload)

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        """Call a service; None where no answer comes in time [s].

        A wire that was just opened gets `DISCOVERY` to find the service first. A service that never answered
        before may get the request several times.
        Answers of Fast DDS say only in a header that Cyclone does not show whose they are: the next answer of
        the service counts.

        Raises:
            SettingsError: there is no such service type, or no such name of a service.
        """
        until = max(time.monotonic() + timeout, self._opened + DISCOVERY)
        reply = f"rr{require_topic(service)}Reply"
        vendor = None
        while vendor is None and time.monotonic() < until:
            with self._lock:
                self._delivery.require_open()
                self._discovery.refresh()
                vendor = next((found.vendor for found in self._of_others() if found.topic == reply), None)
            if vendor is None:
                time.sleep(0.02)
        if vendor is None:
            return None
        with self._lock:
            if service not in self._services:
                numbered = vendor == "Eclipse Cyclone DDS"
                made = CycloneService(self._participant, service, type_name, numbered=numbered)
                self._services[service] = made
                self._graph.add(reader=made.reader, writer=made.writer)
            asked = self._services[service]
        return asked.call(request, until, timeout)

    def connections(self, topic: str) -> int:
        """Return how many publishers we hear on a topic, and how many subscriptions hear us."""
        with self._lock:
            publishers = {
                handle
                for subscription in self._subscriptions
                if subscription.topic == topic
                for handle in subscription.reader.get_matched_publications()
            }
            writer = self._writers.get(topic)
            return len(publishers) + (len(writer.get_matched_subscriptions()) if writer is not None else 0)

    def notices(self) -> list[str]:
        """Return what is to be said since the last call: topics on which nothing comes, and the ways out."""
        return self._silence.notices()

    def close(self) -> None:
        """Leave the graph; may be called twice."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
        self._wake.set(True)
        if threading.current_thread() is not self._thread:
            self._thread.join()
        # Each goes before what it stands on.
        self._waitset = self._wake = self._discovery = self._graph = None
        self._subscriptions = []
        self._services.clear()
        self._writers.clear()
        self._topics.clear()
        self._participant = None
        close_domain(self._domain)

    def _receive(self) -> None:
        look = time.monotonic()
        while not self._closed.is_set():
            self._waitset.wait(_WAIT)
            for subscription in self._subscriptions:
                self._deliver(subscription)
            time.sleep(_PAUSE)
            with self._lock:
                if self._closed.is_set():
                    return
                if time.monotonic() >= look:  # to look costs as much as fifty messages
                    look = time.monotonic() + _LOOK
                    if self._discovery.refresh():
                        self._adapt()
                    self._look_for_silence()

    def _deliver(self, subscription: _Subscription) -> None:
        try:
            messages = take_cdr(subscription.reader)
        except OSError:
            _log.exception("%s cannot be read", subscription.topic)
            return
        arrived = time.time()
        for message in messages:
            subscription.deliver(message, arrived)

    def _adapt(self) -> None:
        """Read again where a publisher offers less than is asked for."""
        for subscription in self._subscriptions:
            quality = hearing_all(self._offered(subscription.topic), latched=subscription.latched)
            if quality == subscription.quality:
                continue
            self._graph.remove(subscription.reader)
            self._waitset.detach(subscription.condition)
            subscription.quality = quality
            subscription.reader, subscription.condition = self._make_reader(
                subscription.topic, subscription.type_name, quality
            )

    def _look_for_silence(self) -> None:
        for subscription in self._subscriptions:
            matched = set(subscription.reader.get_matched_publications())
            self._silence.seen(
                subscription.topic,
                [
                    PublisherSeen(found.vendor, found.type, found.handle in matched)
                    for found in self._of_others()
                    if found.topic == f"rt{subscription.topic}"
                ],
            )

    def _make_reader(self, topic: str, type_name: str, quality: Quality) -> tuple[Any, Any]:
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState
        from cyclonedds.sub import DataReader

        qos = _qos(quality, type_name, depth=_DEPTH)
        reader = DataReader(self._participant, self._topic(f"rt{topic}", type_name), qos=qos)
        condition = ReadCondition(reader, ViewState.Any | SampleState.NotRead | InstanceState.Any)
        self._waitset.attach(condition)
        self._graph.add(reader=reader)
        return reader, condition

    def _topic(self, name: str, type_name: str) -> Any:
        from cyclonedds.topic import Topic

        if (name, type_name) not in self._topics:
            self._topics[name, type_name] = Topic(self._participant, name, cyclone_type(type_name))
        return self._topics[name, type_name]

    def _of_others(self) -> list[Publication]:
        own = self._participant.guid.bytes
        return [found for found in self._discovery.publications() if found.participant != own]

    def _offered(self, topic: str) -> list[Quality]:
        return [found.quality for found in self._discovery.publications() if found.topic == f"rt{topic}"]


def _qos(quality: Quality, type_name: str, *, depth: int) -> Any:
    from cyclonedds.core import Policy, Qos
    from cyclonedds.util import duration

    blocking = duration(milliseconds=100)
    return Qos(
        Policy.Reliability.Reliable(blocking) if quality.reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if quality.latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.Userdata(endpoint_data(type_name)),
    )
