# SPDX-License-Identifier: Apache-2.0
"""A robot without ROS is commanded by lines, and one program at a time is that robot."""

from __future__ import annotations

import io
import json
import socket
from collections.abc import Iterator

import pytest
from live.wires.wire_messages import wait_until

from slipwise.errors import SettingsError
from slipwise.live.drive_guard import DriveBounds, DriveGuard
from slipwise.live.drive_lines import LineDriveLink, PipeDriveLink, UdpDriveLink

READY = '{"t": 12.1, "x": 1, "y": 2, "yaw": 0.3, "dead_man": true}'


def guarded(link: LineDriveLink) -> DriveGuard:
    guard = DriveGuard(DriveBounds(-1.0, 1.0, -1.0, 1.0, 1.0, 1.0))
    link.hear(guard)
    return guard


@pytest.mark.parametrize(
    "line", ["", "no json", "[1]", '{"dead_man": 1}', '{"t": 1, "dead_man": "true"}', "{" * 999]
)
def test_what_is_not_plainly_pressed_is_not(line: str) -> None:
    link = LineDriveLink(lambda _: None)
    guard = guarded(link)
    link.take('{"t": 12.1, "x": 1, "y": 2, "yaw": 0.3}')
    link.take(line)
    assert "dead man" in guard.not_ready()


def test_commands_are_lines_on_the_clock_of_the_poses() -> None:
    results = io.StringIO()
    link = PipeDriveLink(io.StringIO(READY + "\n"), results)
    guard = guarded(link)
    assert wait_until(lambda: guard.not_ready() == "")
    link.send(0.5, -0.1)
    command = json.loads(results.getvalue())
    assert (command["cmd_v"], command["cmd_omega"]) == (0.5, -0.1)
    assert command["t"] == pytest.approx(12.1, abs=5.0)


def test_a_stream_that_ended_is_not_waited_for() -> None:
    link = PipeDriveLink(io.StringIO(""), io.StringIO())
    guarded(link)

    def ended() -> bool:
        try:
            link.missing()
        except SettingsError as problem:
            return "has ended" in str(problem)
        return False

    assert wait_until(ended)


@pytest.fixture
def link() -> Iterator[UdpDriveLink]:
    opened = UdpDriveLink("127.0.0.1:0")
    yield opened
    opened.close()


def test_another_program_takes_nothing_over(link: UdpDriveLink) -> None:
    guard = guarded(link)
    assert link.missing() == "lines from the robot"
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robot,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other,
    ):
        for each in (robot, other):
            each.bind(("127.0.0.1", 0))
            each.settimeout(5.0)
        robot.sendto(READY.encode(), ("127.0.0.1", link.port))
        assert wait_until(lambda: guard.poses == 1)
        other.sendto(READY.replace("12.1", "13").encode(), ("127.0.0.1", link.port))
        robot.sendto(READY.replace("12.1", "12.2").encode(), ("127.0.0.1", link.port))
        assert wait_until(lambda: guard.poses == 2)
        link.send(0.25, 0.0)
        assert json.loads(robot.recv(1000))["cmd_v"] == 0.25
