# SPDX-License-Identifier: Apache-2.0
"""The wire on rclpy, in a Python of its own, talks with a real ROS 2 node."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from live.wires.peer import ROOT, Peer
from live.wires.wire_messages import ODOMETRY, STRING, from_cdr, wait_until

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def node(ros_python: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Peer]:
    """Start slipwise's wire in the Python that has rclpy."""
    environment = {"ROS_LOG_DIR": str(tmp_path_factory.mktemp("ros")), "PYTHONPATH": str(ROOT / "python")}
    with Peer(ros_python, "rclpy_node.py", "slipwise", environment=environment) as peer:
        yield peer


def heard(node: Peer, topic: str, type_name: str) -> list[Any]:
    return [from_cdr(type_name, bytes.fromhex(message)) for message in node.ask("heard")[topic]]


def test_odometry_arrives_whole_and_in_order(node: Peer, robot: Peer) -> None:
    assert robot.ask("match")
    assert wait_until(lambda: node.ask("connections", topic="/odom"))
    robot.ask("drive", count=200, rate=100)
    assert wait_until(lambda: len(node.ask("heard")["/odom"]) >= 200)
    got = heard(node, "/odom", ODOMETRY)
    assert [message.pose.pose.position.x for message in got] == list(range(200))


def test_best_effort_and_latched_topics_are_heard(node: Peer, robot: Peer) -> None:
    assert wait_until(lambda: heard(node, "/robot_description", STRING))
    assert heard(node, "/robot_description", STRING)[0].data == "<robot/>"
    assert wait_until(lambda: robot.ask("drive", count=20, rate=200) and node.ask("heard")["/imu"])


def test_commands_arrive_whole_and_in_order(node: Peer, robot: Peer) -> None:
    assert robot.ask("match")
    assert wait_until(lambda: node.ask("connections", topic="/cmd_vel"))
    node.ask("command", count=100)
    assert wait_until(lambda: len(robot.ask("received")["commands"]) >= 100)
    assert [number for number, _ in robot.ask("received")["commands"]] == list(range(100))
    assert "slipwise" in robot.ask("graph")["nodes"]


def test_a_latched_message_reaches_who_comes_later(node: Peer, robot: Peer) -> None:
    node.ask("model")
    assert wait_until(lambda: robot.ask("received")["models"] == ["schema: 6"])


def test_a_parameter_of_another_node_is_set(node: Peer, robot: Peer) -> None:
    assert node.ask("gain", value=3.5)
    assert robot.ask("gain") == 3.5


def test_topics_of_others_are_listed(node: Peer, robot: Peer) -> None:
    assert wait_until(lambda: ["/odom", ODOMETRY, 1] in node.ask("topics"))
    assert "/cmd_vel" not in [name for name, _, _ in node.ask("topics")]


def test_unknown_types_are_refused_and_closing_twice_leaves_no_thread(node: Peer) -> None:
    assert 'no message type "nav_msgs/msg/Odometer"' in node.ask("refused")
    assert node.ask("close") == []
