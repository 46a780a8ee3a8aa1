# SPDX-License-Identifier: Apache-2.0
"""What a robot on ROS is told: what comes again and again only where somebody listens, the rest always."""

from __future__ import annotations

import numpy as np
import pytest
from live.sample_outputs import next_moves, odometry_at, straight_path, surface_at, waiting_status
from live.test_ros_roles import Wire as BareWire

from slipwise.errors import SettingsError
from slipwise.live.outputs import ModelText, Note
from slipwise.live.requests import asked_commands
from slipwise.live.ros_messages import TOPICS
from slipwise.live.ros_samples import to_pose, to_wheels
from slipwise.live.ros_transport import CLOCK_TYPE, CueTopics, RosTransport
from slipwise.live.samples import Pose, Request, Sample, SurfaceCue, Unusable, Wheels
from slipwise.live.typed_messages import COMMANDS
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import OnMessage, WireTopic
from slipwise.logs.messages import ODOMETRY
from slipwise.logs.options import LogOptions
from slipwise.logs.role_choice import Topic
from slipwise.logs.topics import Roles

NOW = 1e9  # s
CHOSEN = Topic("/odom", ODOMETRY, 1)
LATCHED = {name for name, topic in TOPICS.items() if topic.latched}


class Wire(BareWire):
    """Keeps what is published, and hands over what a test says."""

    def __init__(self, *heard: str) -> None:
        super().__init__({})
        self.heard, self.published = set(heard), list[str]()
        self.takers: dict[str, OnMessage] = {}

    def subscribe(self, topic: str, _type_name: str, on_message: OnMessage, *, latched: bool = False) -> None:
        assert not latched
        self.takers[topic] = on_message

    def publish(self, topic: str, _type_name: str, payload: bytes, *, latched: bool = False) -> None:
        assert latched == (topic.removeprefix("/slipwise/") in LATCHED)
        assert payload
        self.published.append(topic.removeprefix("/slipwise/"))

    def connections(self, topic: str) -> int:
        return int(topic.removeprefix("/slipwise/") in self.heard)


def transport_on(
    wire: Wire, terrain: str | None = None, *, name: str = "slipwise", simulated: bool | None = None
) -> RosTransport:
    roles = Roles(command=None, wheel=CHOSEN, pose=CHOSEN, imu=None, guessed=(), advice={})
    cues = CueTopics(terrain=terrain)
    return RosTransport(wire, roles, LogOptions(), name=name, cues=cues, simulated=simulated)


def test_where_nobody_listens_only_what_comes_once_is_published() -> None:
    wire = Wire()
    transport = transport_on(wire)
    for output in (odometry_at(1.0), straight_path(), waiting_status()):
        transport.publish(output)
    assert wire.published == ["slip_state"]
    wire.published.clear()
    for once in (ModelText(1.0, "x: 1"), Note(1.0, "said"), straight_path(asked=True), surface_at()):
        transport.publish(once)
    transport.publish(next_moves())
    assert wire.published == [
        "model",
        "diagnostics",
        "prediction",
        "prediction_with_covariance",
        "surface",
        "surfaces",
        "next_moves",
    ]


@pytest.mark.parametrize("topic", ["odometry", "twist", "predicted_path", "diagnostics"])
def test_who_listens_to_a_topic_hears_that_one(topic: str) -> None:
    wire = Wire(topic)
    transport = transport_on(wire)
    for output in (odometry_at(1.0), straight_path(), waiting_status()):
        transport.publish(output)
    assert [each for each in wire.published if each != "slip_state"] == [topic]


def test_a_ros_without_slipwise_msgs_is_said_and_gets_the_rest() -> None:
    wire = Wire("diagnostics")
    own = wire.advertise

    def advertise(topic: str, kind: str, *, latched: bool = False) -> None:
        if kind.startswith("slipwise_msgs"):
            raise SettingsError(f'there is no message type "{kind}" in this ROS')
        own(topic, kind, latched=latched)

    def subscribe(topic: str, kind: str, _take: object, *, latched: bool = False) -> None:
        advertise(topic, kind, latched=latched)

    wire.advertise, wire.subscribe = advertise, subscribe  # type: ignore[method-assign]
    transport = transport_on(wire)
    transport.subscribe(lambda _sample: None)
    transport.publish(waiting_status())
    assert wire.published == ["diagnostics"]
    assert [note.split(" is not")[0] for note in transport.notices()] == [
        *(f"/slipwise/{topic}" for topic, about in TOPICS.items() if about.type.startswith("slipwise_msgs")),
        "/slipwise/predict",
    ]
    transport.close()


def test_an_odometry_that_is_wheels_and_pose_gives_both_as_decoding_in_full_does() -> None:
    wire = Wire()
    transport = transport_on(wire)
    samples: list[Sample] = []
    transport.subscribe(samples.append)
    sent = Wire("odometry")
    messages: list[bytes] = []
    sent.publish = lambda _topic, _kind, payload, *, latched=False: messages.append(payload)  # type: ignore[method-assign]
    transport_on(sent).publish(odometry_at(12.5))
    wire.takers["/odom"](messages[0], NOW)
    wire.takers["/odom"](messages[0][:40], NOW)  # cut off: said once, left out
    message = ros_types().deserialize_cdr(messages[0], ODOMETRY)
    whole = [to_wheels(ODOMETRY, LogOptions())(message, 12.5), to_pose(ODOMETRY, LogOptions())(message, 12.5)]
    assert samples[:2] == whole
    assert isinstance(samples[0], Wheels)
    assert isinstance(samples[1], Pose)
    (unusable,) = samples[2:]
    assert isinstance(unusable, Unusable)
    assert unusable.text.startswith("messages of /odom that cannot be read are left out")
    transport.close()


def test_after_the_end_nothing_is_asked_of_the_wire_nor_sent() -> None:
    wire = Wire("odometry", "diagnostics")
    transport = transport_on(wire)
    transport.subscribe(lambda _sample: None)
    transport.close()
    wire.heard = None  # type: ignore[assignment]  # whoever asks it fails
    for output in (odometry_at(1.0), waiting_status(), Note(1.0, "said"), surface_at()):
        transport.publish(output)
    assert wire.published == []


def test_labels_come_on_two_topics_and_a_change_on_its_own() -> None:
    wire, samples = Wire(), list[Sample]()
    transport_on(wire, "/label").subscribe(samples.append)
    store = ros_types()
    string, empty = store.types["std_msgs/msg/String"], store.types["std_msgs/msg/Empty"]
    for topic, text in (("/slipwise/terrain", "sand"), ("/label", "gravel"), ("/label", "")):
        message = string(text)  # type: ignore[call-arg]
        wire.takers[topic](bytes(store.serialize_cdr(message, "std_msgs/msg/String")), NOW)
    wire.takers["/slipwise/terrain_changed"](bytes(store.serialize_cdr(empty(), "std_msgs/msg/Empty")), NOW)
    assert [sample for sample in samples if isinstance(sample, SurfaceCue)] == [
        SurfaceCue("sand"),
        SurfaceCue("gravel"),
        SurfaceCue(" "),  # no name, and no change: counted
        SurfaceCue(),
    ]


@pytest.mark.parametrize(
    ("simulated", "published", "heeds"),
    [(None, True, True), (None, False, False), (True, False, True), (False, True, False)],
)
def test_the_clock_is_that_of_the_parameter_or_where_somebody_publishes_it(
    simulated: bool | None, published: bool, heeds: bool
) -> None:
    wire = Wire()
    wire.topics = lambda: [WireTopic("/clock", CLOCK_TYPE, 1)] if published else []  # type: ignore[method-assign]
    transport_on(wire, simulated=simulated).subscribe(lambda _sample: None)
    assert ("/clock" in wire.takers) == heeds


@pytest.mark.parametrize("names", [("v", "omega"), ("v", "steering")])
def test_a_prediction_is_asked_for_with_one_message_however_the_robot_turns(names: tuple[str, str]) -> None:
    wire, samples = Wire(), list[Sample]()
    transport_on(wire).subscribe(samples.append)
    store, axes = ros_types(), ("t", "v", "vy", "omega")
    numbers = dict(zip(axes, map(np.array, ([0.0, 1.0], [0.5, 0.6], [], [0.1, 0.2])), strict=True))
    message = store.types[COMMANDS](horizon=3.0, **numbers)  # type: ignore[call-arg]
    wire.takers["/slipwise/predict"](bytes(store.serialize_cdr(message, COMMANDS)), NOW)
    (request,) = samples
    assert isinstance(request, Request)
    rows, horizon = asked_commands(request.content, names, newest=10.0, horizon=2.0)
    assert (rows.tolist(), horizon) == ([[10.0, 0.5, 0.1], [11.0, 0.6, 0.2]], 3.0)


def test_topics_of_a_node_in_a_namespace_are_below_it() -> None:
    wire = Wire()
    transport_on(wire, name="robot_1/slipwise").subscribe(lambda _sample: None)
    assert {"/robot_1/slipwise/apply", "/robot_1/slipwise/predict"} <= set(wire.takers)
