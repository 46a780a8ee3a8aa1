# SPDX-License-Identifier: Apache-2.0
"""The wire on rospy talks with a node of ROS 1 through a real roscore, where Debian has it installed."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from live.wires.peer import ROOT, Peer
from live.wires.wire_messages import ODOMETRY, STRING, from_cdr, wait_until

pytestmark = pytest.mark.slow

_DEBIAN = Path("/usr/lib/python3/dist-packages")


@pytest.fixture(scope="module")
def noetic(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Start a roscore on loopback, and give the environment that finds it."""
    if shutil.which("roscore") is None or not (_DEBIAN / "nav_msgs").is_dir():
        pytest.skip("ROS 1 is not installed (Debian 12: apt install ros-core python3-nav-msgs)")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    folder = tmp_path_factory.mktemp("noetic")
    told = {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(folder),
        "ROS_LOG_DIR": str(folder),
    }
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    kept["PATH"] = "/usr/bin:/bin"
    core = subprocess.Popen(
        ["/usr/bin/roscore", "-p", str(port)],
        env={**kept, **told},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        if not wait_until(lambda: answers(port), 20.0):
            pytest.skip("roscore does not start here")
        yield told
    finally:
        os.killpg(core.pid, signal.SIGINT)
        core.wait(20.0)


def answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture(scope="module")
def robot(noetic: dict[str, str]) -> Iterator[Peer]:
    with Peer(Path("/usr/bin/python3"), "rospy_robot.py", environment=noetic) as peer:
        yield peer


@pytest.fixture(scope="module")
def node(noetic: dict[str, str]) -> Iterator[Peer]:
    if sys.version_info[:2] != (3, 11):
        pytest.skip("Debian's rospy is for Python 3.11")
    found = f"{ROOT / 'python'}:{ROOT / 'python' / 'tests'}:{_DEBIAN}"
    with Peer(Path(sys.executable), "rospy_node.py", environment={**noetic, "PYTHONPATH": found}) as peer:
        yield peer


def test_odometry_of_ros_1_arrives_as_messages_of_ros_2(node: Peer, robot: Peer) -> None:
    assert wait_until(lambda: node.ask("connections", topic="/odom"))
    robot.ask("drive", count=100)
    assert wait_until(lambda: len(node.ask("heard")["heard"]) >= 100, 3.0), len(node.ask("heard")["heard"])
    got = [from_cdr(ODOMETRY, bytes.fromhex(message)) for message in node.ask("heard")["heard"]]
    assert [message.pose.pose.position.x for message in got] == list(range(100))
    assert (got[0].header.stamp.sec, got[0].header.stamp.nanosec, got[0].child_frame_id) == (
        100,
        5,
        "base_link",
    )


def test_latched_topics_of_ros_1_are_heard(node: Peer, robot: Peer) -> None:
    assert wait_until(lambda: node.ask("heard")["text"])
    assert from_cdr(STRING, bytes.fromhex(node.ask("heard")["text"][0])).data == "<robot/>"


def test_commands_reach_a_node_of_ros_1(node: Peer, robot: Peer) -> None:
    assert wait_until(lambda: node.ask("connections", topic="/cmd_vel"))
    node.ask("command", count=20)
    assert wait_until(lambda: len(robot.ask("commands")) == 20)
    got = robot.ask("commands")
    assert [speed for speed, _, _ in got] == list(range(20))
    assert got[0][1] > 1_600_000_000
    assert got[0][2] == "base_link"


def test_topics_of_ros_1_are_listed_by_their_names_in_ros_2(node: Peer, robot: Peer) -> None:
    assert ["/odom", ODOMETRY, 1] in node.ask("topics")
    assert "/cmd_vel" not in [name for name, _, _ in node.ask("topics")]


def test_a_closed_node_of_ros_1_publishes_nothing_more(node: Peer) -> None:
    assert "closed" in node.ask("close")
