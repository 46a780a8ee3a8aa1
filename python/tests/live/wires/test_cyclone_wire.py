# SPDX-License-Identifier: Apache-2.0
"""A node on Cyclone DDS talks with others of its kind and with a real ROS 2 node."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from live.wires.peer import DOMAIN, Peer
from live.wires.wire_messages import (
    ODOMETRY,
    STRING,
    TWIST,
    command,
    from_cdr,
    set_parameter,
    to_cdr,
    wait_until,
)

from slipwise.errors import SettingsError
from slipwise.live.wires.cyclone_bytes import take_cdr, write_cdr
from slipwise.live.wires.cyclone_types import cyclone_type
from slipwise.live.wires.cyclone_wire import CycloneWire
from slipwise.live.wires.ros_types import type_hash
from slipwise.live.wires.wire import OnMessage, WireOptions

pytest.importorskip("cyclonedds")


@pytest.fixture(scope="module")
def wire() -> Iterator[CycloneWire]:
    opened = CycloneWire(WireOptions(domain=DOMAIN))
    yield opened
    opened.close()


@pytest.fixture
def other() -> Iterator[CycloneWire]:
    opened = CycloneWire(WireOptions(node_name="other", domain=DOMAIN))
    yield opened
    opened.close()


def keep(messages: list[bytes]) -> OnMessage:
    return lambda message, _arrived: messages.append(message)


def places(messages: list[bytes]) -> list[float]:
    return [from_cdr(ODOMETRY, message).pose.pose.position.x for message in messages]


def test_bytes_arrive_as_they_were_sent(wire: CycloneWire, other: CycloneWire) -> None:
    got: list[bytes] = []
    wire.subscribe("/bytes", TWIST, keep(got))
    sent = [command(number) for number in range(20)]
    for message in sent:
        other.publish("/bytes", TWIST, message)
    assert wait_until(lambda: len(got) >= len(sent))
    assert [message[: len(sent[0])] for message in got] == sent


def test_who_comes_later_gets_the_latched_message(wire: CycloneWire, other: CycloneWire) -> None:
    got: list[bytes] = []
    other.publish("/latched", STRING, to_cdr(STRING, data="first"), latched=True)
    other.publish("/latched", STRING, to_cdr(STRING, data="last"), latched=True)
    wire.subscribe("/latched", STRING, keep(got), latched=True)
    assert wait_until(lambda: got)
    assert [from_cdr(STRING, message).data for message in got] == ["last"]


def test_publishers_of_others_are_listed(wire: CycloneWire, other: CycloneWire) -> None:
    wire.advertise("/mine", STRING)
    other.advertise("/theirs", TWIST)
    assert wait_until(lambda: any(topic.name == "/theirs" for topic in wire.topics()))
    found = {topic.name: topic for topic in wire.topics()}
    assert (found["/theirs"].type, found["/theirs"].publishers) == (TWIST, 1)
    assert "/mine" not in found


def test_a_callback_that_fails_does_not_stop_the_others(wire: CycloneWire, other: CycloneWire) -> None:
    got: list[bytes] = []

    def fail(message: bytes, _arrived: float) -> None:
        got.append(message)
        raise ValueError("not understood")

    wire.subscribe("/failing", STRING, fail)
    for _ in range(3):
        other.publish("/failing", STRING, to_cdr(STRING, data="x"))
    assert wait_until(lambda: len(got) == 3)


def test_unknown_types_and_relative_names_are_refused(wire: CycloneWire) -> None:
    with pytest.raises(SettingsError, match='no message type "nav_msgs/msg/Odometer"'):
        wire.subscribe("/odom", "nav_msgs/msg/Odometer", print)
    with pytest.raises(SettingsError, match="not the name of a topic"):
        wire.advertise("odom", ODOMETRY)


def test_a_closed_wire_leaves_no_thread_and_may_be_closed_again() -> None:
    before = set(threading.enumerate())
    opened = CycloneWire(WireOptions(node_name="short", domain=DOMAIN))
    opened.subscribe("/odom", ODOMETRY, lambda _message, _arrived: None)
    opened.close()
    opened.close()
    assert set(threading.enumerate()) <= before
    with pytest.raises(SettingsError, match="closed"):
        opened.publish("/x", STRING, to_cdr(STRING, data="x"))


class Server:
    """Answers a trigger with a count; its first answers are lost, as where a reader is found late."""

    def __init__(self, service: str, lost: int) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.domain import DomainParticipant
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.History.KeepLast(10),
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )
        participant = DomainParticipant(DOMAIN)
        request = cyclone_type("std_srvs/srv/Trigger_Request", numbered=True)
        response = cyclone_type("std_srvs/srv/Trigger_Response", numbered=True)
        self._reader = DataReader(participant, Topic(participant, f"rq{service}Request", request), qos=qos)
        self._writer = DataWriter(participant, Topic(participant, f"rr{service}Reply", response), qos=qos)
        self._lost = lost
        self.asked = 0
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        while not self._closed.wait(0.005):
            for request in take_cdr(self._reader):
                self.asked += 1
                if self.asked > self._lost:
                    answer = to_cdr("std_srvs/srv/Trigger_Response", success=True, message=str(self.asked))
                    write_cdr(self._writer, answer[:4] + request[4:20] + answer[4:])

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._thread.join()


@pytest.mark.parametrize(("lost", "asked"), [(0, [1, 2, 3]), (1, [2, 3, 4]), (3, [4, 5, 6])])
def test_a_service_whose_first_answers_are_lost_is_asked_again(
    wire: CycloneWire, lost: int, asked: list[int]
) -> None:
    service = f"/press_{lost}"
    with Server(service, lost) as server:
        for count in asked:
            answer = wire.call(service, "std_srvs/srv/Trigger", b"\x00\x01\x00\x00\x00", timeout=5.0)
            assert answer is not None
            assert from_cdr("std_srvs/srv/Trigger_Response", answer).message == str(count)
        assert server.asked == asked[-1]


@pytest.mark.slow
def test_a_refused_publisher_is_said_once_with_the_ways_out(wire: CycloneWire) -> None:
    from cyclonedds.core import Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter, Publisher
    from cyclonedds.topic import Topic

    participant = DomainParticipant(DOMAIN)
    elsewhere = Publisher(participant, qos=Qos(Policy.Partition(partitions=["elsewhere"])))
    topic = Topic(participant, "rt/refused", cyclone_type(ODOMETRY))
    writer = DataWriter(elsewhere, topic)
    wire.subscribe("/refused", ODOMETRY, lambda _message, _arrived: None)
    said: list[str] = []
    assert wait_until(lambda: said.extend(wire.notices()) or any("/refused" in text for text in said))
    text = next(text for text in said if "/refused" in text)
    assert "Eclipse Cyclone DDS publishes it" in text
    assert all(way in text for way in ("rclpy", "fastdds.type_propagation=disabled"))
    time.sleep(0.6)
    assert not [text for text in wire.notices() if "/refused" in text]
    del writer


@pytest.mark.slow
def test_odometry_of_a_real_node_arrives_whole_and_in_order(wire: CycloneWire, robot: Peer) -> None:
    got: list[bytes] = []
    wire.subscribe("/odom", ODOMETRY, keep(got))
    wire.advertise("/cmd_vel", TWIST)
    assert robot.ask("match")
    assert wait_until(lambda: wire.connections("/odom"))
    assert robot.ask("drive", count=200, rate=100) == 200
    assert wait_until(lambda: len(got) >= 200)
    first = from_cdr(ODOMETRY, got[0])
    assert places(got) == list(range(200))
    assert (first.child_frame_id, first.pose.covariance[35]) == ("base_link", 0.25)


@pytest.mark.slow
def test_commands_reach_a_real_node_whole_and_in_order(wire: CycloneWire, robot: Peer) -> None:
    wire.advertise("/cmd_vel", TWIST)
    assert robot.ask("match")
    assert wait_until(lambda: wire.connections("/cmd_vel"))
    for number in range(200):
        wire.publish("/cmd_vel", TWIST, command(number))
        time.sleep(0.01)
    assert wait_until(lambda: len(robot.ask("received")["commands"]) >= 200)
    assert [number for number, _ in robot.ask("received")["commands"]] == list(range(200))


@pytest.mark.slow
def test_a_real_node_sees_our_name_and_the_hash_of_our_type(wire: CycloneWire, robot: Peer) -> None:
    wire.advertise("/cmd_vel", TWIST)
    assert wait_until(lambda: ["slipwise", type_hash(TWIST)] in robot.ask("graph")["publishers"])
    assert "slipwise" in robot.ask("graph")["nodes"]


@pytest.mark.slow
def test_best_effort_and_latched_topics_of_a_real_node_are_heard(wire: CycloneWire, robot: Peer) -> None:
    imu: list[bytes] = []
    text: list[bytes] = []
    wire.subscribe("/imu", "sensor_msgs/msg/Imu", keep(imu))
    wire.subscribe("/robot_description", STRING, keep(text), latched=True)
    assert wait_until(lambda: text)
    assert from_cdr(STRING, text[0]).data == "<robot/>"
    assert wait_until(lambda: robot.ask("drive", count=20, rate=200) and imu)


@pytest.mark.slow
def test_a_latched_message_of_ours_reaches_a_real_node(wire: CycloneWire, robot: Peer) -> None:
    wire.publish("/slipwise/model", STRING, to_cdr(STRING, data="schema: 6"), latched=True)
    assert wait_until(lambda: robot.ask("received")["models"] == ["schema: 6"])


@pytest.mark.slow
def test_a_parameter_of_a_real_node_is_set(wire: CycloneWire, robot: Peer) -> None:
    request = set_parameter("gain", 2.5)
    answer = wire.call("/robot/set_parameters", "rcl_interfaces/srv/SetParameters", request, timeout=10.0)
    assert answer is not None
    assert from_cdr("rcl_interfaces/srv/SetParameters_Response", answer).results[0].successful
    assert robot.ask("gain") == 2.5


@pytest.mark.slow
def test_a_service_that_nobody_serves_gives_no_answer(wire: CycloneWire) -> None:
    empty = b"\x00\x01\x00\x00\x00"
    assert wire.call("/nobody/press", "std_srvs/srv/Trigger", empty, timeout=0.2) is None


@pytest.mark.slow
def test_a_real_node_that_dies_and_returns_is_heard_again(
    wire: CycloneWire, ros_python: Path, tmp_path: Path
) -> None:
    got: list[bytes] = []
    wire.subscribe("/odom", ODOMETRY, keep(got))
    wire.advertise("/cmd_vel", TWIST)
    for _ in range(2):
        with Peer(ros_python, "jazzy_node.py", environment={"ROS_LOG_DIR": str(tmp_path)}) as robot:
            assert robot.ask("match")
            got.clear()
            assert wait_until(lambda: robot.ask("drive", count=1, rate=100) and got)
            robot.ask("drive", count=50, rate=100)
            assert wait_until(lambda: places(got[-50:]) == list(range(50)))
            robot.kill()
