# SPDX-License-Identifier: Apache-2.0
"""A robot on ROS as a transport, whatever wire carries its messages."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from slipwise.errors import SlipwiseError
from slipwise.live.cdr_reader import reader_of
from slipwise.live.first_messages import FirstMessages
from slipwise.live.outputs import AppliedParameters, Output, Status
from slipwise.live.parameter_call import NodeParameters
from slipwise.live.ros_messages import TOPICS, RosMessages, RosTopic
from slipwise.live.ros_roles import Use, uses_of
from slipwise.live.ros_samples import (
    NOTHING_SEEN,
    FirstPoses,
    FixPoses,
    ImuOrientation,
    ToPose,
    to_command,
    to_gyro,
    to_pose,
    to_wheels,
)
from slipwise.live.samples import Override, Pose, Request, SurfaceCue, Unusable
from slipwise.live.stamps import Stamps
from slipwise.live.transport import OnSample, Transport
from slipwise.live.typed_messages import COMMANDS, asked_of
from slipwise.live.wires.ros_types import OWN_PACKAGE, ros_types
from slipwise.live.wires.wire import OnMessage, RosWire
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.wheel_layout import LayoutWatch
from slipwise.logs.messages import NAV_SAT_FIX
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import Topic
from slipwise.logs.topics import Roles

CLOCK, CLOCK_TYPE = "/clock", "rosgraph_msgs/msg/Clock"
BOOL, EMPTY, STRING = "std_msgs/msg/Bool", "std_msgs/msg/Empty", "std_msgs/msg/String"
DIAGNOSTICS_EVERY = 1.0  # s of the wall clock

ToSample = Callable[[Any, float], Any]
LOOK_EVERY = 0.5  # s between two looks; who comes meanwhile hears nothing until then


@dataclass(frozen=True)
class CueTopics:
    """Topics on which others say what they know of the drive."""

    override: str | None = None  # std_msgs/Bool that is true while an operator drives
    terrain: str | None = None  # std_msgs/String with the name of the surface, beside `~/terrain`


_NO_CUES = CueTopics()


class RosTransport(Transport):
    """Reads the topics of the roles, publishes below the node's name, sets parameters of other nodes.

    Args:
        wire: carries the messages.
        roles: which topic is what.
        options: scales and sizes.
        name: of the node.
        cues: topics on which others say what they know.
        seen: what the first poses show.
        simulated: whether /clock gives the time; None: where somebody publishes it.
        first: messages of the topics that came before; None: none.
    """

    def __init__(  # noqa: PLR0913 (what it reads, and how)
        self,
        wire: RosWire,
        roles: Roles,
        options: LogOptions,
        *,
        name: str,
        cues: CueTopics = _NO_CUES,
        seen: FirstPoses = NOTHING_SEEN,
        simulated: bool | None = None,
        first: FirstMessages | None = None,
    ) -> None:
        self._first, self._takers = first or FirstMessages(wire), dict[str, OnMessage]()
        self._wire, self._roles, self._options = wire, roles, options
        self._name, self._override, self._terrain = name, cues.override, cues.terrain
        self._seen, self._simulated = seen, simulated
        self._messages, self._listeners = RosMessages(name), Listeners(wire.connections)
        self._reading = ros_types()
        self._layout = None if options.wheels is None else LayoutWatch(options.wheels)
        self._notices: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._stamps = Stamps("" if roles.pose is None else roles.pose.name, self._notices.put)
        self._calls: queue.SimpleQueue[AppliedParameters | None] = queue.SimpleQueue()
        self._caller = threading.Thread(target=self._call_nodes, name="parameters", daemon=True)
        self._unknown: set[str] = set()  # topics whose types this ROS does not have
        self._closed = False
        self._said, self._said_at = ("", ""), -DIAGNOSTICS_EVERY

    def found(self) -> tuple[Finding, ...]:
        """Return what the readings of described wheels show to be wrong."""
        return () if self._layout is None else self._layout.found()

    def subscribe(self, on_sample: OnSample) -> None:
        """Subscribe to the topics of the roles, and announce what is published.

        Raises:
            SlipwiseError: a topic cannot be used.
        """
        for topic, about in TOPICS.items():
            self._advertise(topic, about)
        if self._simulated or (
            self._simulated is None and any(topic.name == CLOCK for topic in self._wire.topics())
        ):
            self._stamps.simulated = True
            self._notices.put("stamps without a header are those of /clock")
            self._take(
                CLOCK, CLOCK_TYPE, lambda message, _: self._stamps.take_clock(message.clock), on_sample
            )
        self._subscribe_roles(on_sample)
        if self._override is not None:
            self._take(self._override, BOOL, lambda message, t: Override(t, bool(message.data)), on_sample)
        self._take(self._full("apply"), EMPTY, lambda _message, _t: Request("apply"), on_sample)
        for topic in filter(None, (self._full("terrain"), self._terrain)):
            self._take(topic, STRING, lambda message, _: SurfaceCue(message.data or " "), on_sample)
        changed = self._full("terrain_changed")
        self._take(changed, EMPTY, lambda _message, _t: SurfaceCue(), on_sample)
        self._take_own(
            "predict", COMMANDS, lambda message, _: Request("predict", asked_of(message)), on_sample
        )
        self._first.hand_over(self._takers)
        self._caller.start()

    def publish(self, output: Output) -> None:
        """Publish an output that has a subscriber; parameters of other nodes are set by a thread of its own.

        What is latched, notes and answers are published all the same: they come once.
        """
        if self._closed:  # the last words of the node are for those that watch it
            return
        if isinstance(output, AppliedParameters):
            self._calls.put(output)
            return
        for message in self._messages.of(output, partial(self._wanted, output)):
            if message.topic in self._unknown:
                continue
            with contextlib.suppress(SlipwiseError):
                self._wire.publish(
                    self._full(message.topic), message.type, message.payload, latched=message.latched
                )

    def _wanted(self, output: Output, topic: str) -> bool:
        heard = self._listeners.on(self._full(topic))
        return heard and (not isinstance(output, Status) or self._is_news(output))

    def _take_own(self, topic: str, kind: str, convert: ToSample, on_sample: OnSample) -> None:
        """Subscribe to a type of slipwise_msgs where this ROS has it."""
        with self._said_where_unknown(topic, kind, "is not listened to"):
            self._take(self._full(topic), kind, convert, on_sample)

    def _advertise(self, topic: str, about: RosTopic) -> None:
        with self._said_where_unknown(topic, about.type, "is not published"):
            self._wire.advertise(self._full(topic), about.type, latched=about.latched)

    @contextlib.contextmanager
    def _said_where_unknown(self, topic: str, kind: str, consequence: str) -> Iterator[None]:
        """A ROS without slipwise_msgs does without what needs them, and that is said."""
        try:
            yield
        except SlipwiseError as problem:
            if not kind.startswith(OWN_PACKAGE):
                raise
            self._unknown.add(topic)
            self._notices.put(f"{self._full(topic)} {consequence}: {problem}")

    def _is_news(self, status: Status) -> bool:
        """Diagnostics come once a second, as is usual in ROS, or where something changed."""
        now, said = time.monotonic(), (status.state, status.validity)
        if said == self._said and now < self._said_at + DIAGNOSTICS_EVERY:
            return False
        self._said, self._said_at = said, now
        return True

    def notices(self) -> list[str]:
        """Return what is to be said since the last call."""
        found = self._wire.notices()
        with contextlib.suppress(queue.Empty):
            while True:
                found.append(self._notices.get_nowait())
        return found

    @property
    def wheels(self) -> bool:
        """Whether there is a topic with them."""
        return self._roles.wheel is not None

    @property
    def clocks_compared(self) -> bool:
        """Whether headers were compared with the times of arrival."""
        return self._stamps.compared

    def close(self) -> None:
        """Leave the graph."""
        if not self._closed:
            self._closed = True
            self._calls.put(None)
            self._wire.close()

    def _full(self, topic: str) -> str:
        return f"/{self._name}/{topic}"

    def _subscribe_roles(self, on_sample: OnSample) -> None:
        imu = None if self._roles.imu is None else ImuOrientation()
        kinds: dict[str, str] = {}
        converters: dict[str, list[ToSample]] = {}  # one topic may be both wheels and pose
        for use, topic in uses_of(self._roles):
            kinds[topic.name] = topic.type
            converters.setdefault(topic.name, []).append(self._converter(use, topic, imu))
        for name, found in converters.items():
            self._take(name, kinds[name], _all_of(found), on_sample)

    def _converter(self, use: Use, topic: Topic, imu: ImuOrientation | None) -> ToSample:
        kind, options = topic.type, self._options
        match use:
            case "command":
                return to_command(kind, options)
            case "wheel":
                return to_wheels(kind, options, self._notices.put, topic.name, self._layout)
            case "pose":
                if kind == NAV_SAT_FIX:
                    return FixPoses(options, imu).take
                return to_pose(kind, options, self._notices.put, topic.name, self._seen, imu)
            case "orientation":
                assert imu is not None
                return imu.take
            case "gyro":
                return to_gyro
            case "other":
                alone = FixPoses(options, None).take
                pose = to_pose(kind, options, self._notices.put, topic.name) if kind != NAV_SAT_FIX else alone
                return _from_source(pose, topic.name)

    def _take(self, topic: str, kind: str, convert: ToSample, on_sample: OnSample) -> None:
        """Subscribe; a message that cannot be read is said once, and left out."""
        read = reader_of(kind, self._reading)

        def take(payload: bytes, arrived: float) -> None:
            try:
                message = read(payload)
                samples = convert(message, self._stamps.of(message, arrived, topic))
            except Exception as problem:
                reason = f"messages of {topic} that cannot be read"
                on_sample(Unusable(reason, f"{reason} are left out: {problem}", kind=topic))
                return
            for sample in samples if isinstance(samples, list) else [samples]:
                if sample is not None:
                    on_sample(sample)

        if topic in self._first.topics:
            self._takers[topic] = take
        else:
            self._wire.subscribe(topic, kind, take)

    def _call_nodes(self) -> None:
        nodes = NodeParameters(self._wire, self._reading)
        while (applied := self._calls.get()) is not None:
            try:
                said = nodes.set(applied)
            except Exception as problem:  # the next call may be sound
                said = f"{applied.node}: its parameters cannot be set: {problem}"
            if said:
                self._notices.put(said)


def _from_source(convert: ToPose, source: str) -> ToSample:
    def sourced(message: Any, t: float) -> Pose | None:
        pose = convert(message, t)
        return None if pose is None else replace(pose, source=source)

    return sourced


def _all_of(converters: list[ToSample]) -> ToSample:
    return lambda message, t: [convert(message, t) for convert in converters]


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
