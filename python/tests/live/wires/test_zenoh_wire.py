# SPDX-License-Identifier: Apache-2.0
"""A node on Zenoh talks with others of its kind and with a node of pyzeros."""

from __future__ import annotations

import socket
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
    to_cdr,
    wait_until,
)

from slipwise.errors import SettingsError
from slipwise.live.wires.options import WireOptions
from slipwise.live.wires.zenoh_wire import ZenohWire

pytest.importorskip("zenoh")
pytestmark = pytest.mark.slow


def free_address() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


@pytest.fixture(scope="module")
def router() -> Iterator[str]:
    """Start a router on loopback and give its address."""
    import zenoh

    address = free_address()
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["{address}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    session = zenoh.open(config)
    yield address
    session.close()


@pytest.fixture
def wire(router: str) -> Iterator[ZenohWire]:
    opened = ZenohWire(WireOptions(domain=DOMAIN, router=router))
    yield opened
    opened.close()


@pytest.fixture
def other(router: str) -> Iterator[ZenohWire]:
    opened = ZenohWire(WireOptions(node_name="other", domain=DOMAIN, router=router))
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def met(ros_python: Path) -> Iterator[tuple[Peer, ZenohWire]]:
    """Start a node of pyzeros, and a wire that connects to it without a router."""
    address = free_address()
    with Peer(ros_python, "pyzeros_node.py", address, environment={}, patience=240.0) as peer:
        wire = ZenohWire(WireOptions(domain=DOMAIN, router=address))
        yield peer, wire
        wire.close()


def test_bytes_arrive_as_they_were_sent(wire: ZenohWire, other: ZenohWire) -> None:
    got: list[bytes] = []
    wire.subscribe("/bytes", TWIST, got.append)
    other.advertise("/bytes", TWIST)
    assert wait_until(lambda: other.connections("/bytes") == 1 and wire.connections("/bytes") == 1)
    sent = [command(number) for number in range(20)]
    for message in sent:
        other.publish("/bytes", TWIST, message)
    assert wait_until(lambda: len(got) >= len(sent))
    assert got == sent


def test_who_comes_later_gets_the_latched_message(wire: ZenohWire, other: ZenohWire) -> None:
    got: list[bytes] = []
    other.publish("/latched", STRING, to_cdr(STRING, data="first"), latched=True)
    other.publish("/latched", STRING, to_cdr(STRING, data="last"), latched=True)
    wire.subscribe("/latched", STRING, got.append, latched=True)
    assert wait_until(lambda: got)
    assert [from_cdr(STRING, message).data for message in got] == ["last"]


def test_publishers_of_others_are_listed_while_they_live(wire: ZenohWire, other: ZenohWire) -> None:
    wire.advertise("/mine", STRING)
    other.advertise("/theirs", TWIST)
    assert wait_until(lambda: [topic.name for topic in wire.topics()] == ["/theirs"])
    assert (wire.topics()[0].type, wire.topics()[0].publishers) == (TWIST, 1)
    other.close()
    assert wait_until(lambda: wire.topics() == [])


def test_another_type_on_a_wanted_topic_is_said_once(wire: ZenohWire, other: ZenohWire) -> None:
    wire.subscribe("/cmd_vel", TWIST, lambda message: None)
    other.advertise("/cmd_vel", "geometry_msgs/msg/Twist")
    said: list[str] = []
    assert wait_until(lambda: said.extend(wire.notices()) or said)
    assert "as geometry_msgs/msg/Twist, not as geometry_msgs/msg/TwistStamped" in said[0]
    time.sleep(0.5)
    assert wire.notices() == []


def test_a_router_that_is_not_there_is_said_once_and_closing_twice_leaves_no_thread() -> None:
    before = set(threading.enumerate())
    address = free_address()
    wire = ZenohWire(WireOptions(domain=DOMAIN, router=address))
    said: list[str] = []
    assert wait_until(lambda: said.extend(wire.notices()) or said)
    assert f"no Zenoh router at {address}" in said[0]
    assert wire.notices() == []
    wire.close()
    wire.close()
    assert set(threading.enumerate()) <= before
    with pytest.raises(SettingsError, match="closed"):
        wire.publish("/x", STRING, to_cdr(STRING, data="x"))


def test_a_router_of_no_meaning_is_refused() -> None:
    with pytest.raises(SettingsError, match="Zenoh does not start"):
        ZenohWire(WireOptions(domain=DOMAIN, router="robot"))


def test_odometry_of_a_node_of_pyzeros_arrives_whole_and_in_order(met: tuple[Peer, ZenohWire]) -> None:
    peer, wire = met
    got: list[bytes] = []
    wire.subscribe("/odom", ODOMETRY, got.append)
    assert wait_until(lambda: wire.connections("/odom"))
    time.sleep(0.3)  # until the other side knows of the subscription
    peer.ask("drive", count=200, rate=100)
    assert wait_until(lambda: len(got) >= 200)
    messages = [from_cdr(ODOMETRY, message) for message in got]
    assert [message.pose.pose.position.x for message in messages] == list(range(200))
    assert messages[0].child_frame_id == "base_link"


def test_commands_reach_a_node_of_pyzeros_with_their_attachment(met: tuple[Peer, ZenohWire]) -> None:
    peer, wire = met
    wire.advertise("/cmd_vel", TWIST)
    assert wait_until(lambda: wire.connections("/cmd_vel"))
    for number in range(100):
        wire.publish("/cmd_vel", TWIST, command(number))
        time.sleep(0.01)
    assert wait_until(lambda: len(peer.ask("commands")) >= 100)
    got = peer.ask("commands")
    assert [(number, sequence) for number, _, sequence, _ in got] == [(n, n + 1) for n in range(100)]
    assert {length for *_, length in got} == {33}


def test_our_tokens_are_those_that_pyzeros_would_write(met: tuple[Peer, ZenohWire]) -> None:
    peer, wire = met
    wire.advertise("/cmd_vel", TWIST)
    tokens = peer.ask("tokens")
    kinds = [token.split("/")[5:] for token in tokens["found"] if token.split("/")[8] == "slipwise"]
    assert tokens["expected"].split("/")[5:] in kinds
    assert ["NN", "%", "%", "slipwise"] in kinds


def test_a_service_of_a_node_of_pyzeros_answers(met: tuple[Peer, ZenohWire]) -> None:
    peer, wire = met
    service, empty = "std_srvs/srv/Trigger", b"\x00\x01\x00\x00\x00"
    answer = wire.call("/robot/press", service, empty, timeout=10.0)
    assert answer is not None, peer.ask("pressed")
    read = from_cdr(f"{service}_Response", answer)
    assert (read.success, read.message) == (True, "pressed")
    assert peer.ask("pressed") == 1
    assert wire.call("/nobody/press", service, empty, timeout=0.2) is None
