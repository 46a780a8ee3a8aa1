# SPDX-License-Identifier: Apache-2.0
"""`slipwise excite --drive` wants limit, button and pose, and drives a simulated robot over Cyclone DDS."""

from __future__ import annotations

import json
import math
import os
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from cli.conftest import Result
from excitation.samples import small_drive

from slipwise.cli.excite_drive import bounds_of, summary_of
from slipwise.live.drive_lines import LineDriveLink
from slipwise.live.self_drive import DriveReport
from slipwise.logs import open_log

Slipwise = Callable[..., Result]
DOMAIN = 1 + os.getpid() % 100
DRIVE = ("excite", "--vehicle", "husky", "--drive")
ALL = ("--speed", "0.5", "--dead-man", "/joy", "--pose-topic", "/pose")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (ALL[2:], "--speed"),
        ((*ALL[:2], *ALL[4:]), "--dead-man"),
        (ALL[:4], "--pose-topic"),
        (("--transport", "udp"), "--speed"),
        ((*ALL, "--rate", "2"), "--rate"),
        ((*ALL, "--countdown", "-1"), "--countdown"),
    ],
)
def test_without_limit_button_or_pose_nothing_drives(
    slipwise: Slipwise, folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    result = slipwise(*DRIVE, *arguments)
    assert result.code == 2
    assert message in result.err
    assert list(folder.iterdir()) == []


@pytest.mark.slow
def test_the_bounds_are_those_that_the_drive_was_checked_with() -> None:
    drive = small_drive()
    bounds, box = bounds_of(drive), drive.box
    assert bounds.left <= box[0]
    assert bounds.right >= box[1]
    assert bounds.bottom <= box[2]
    assert bounds.top >= box[3]
    assert bounds.right - bounds.left == pytest.approx(7.0)
    assert bounds.top - bounds.bottom == pytest.approx(6.0)
    assert (bounds.speed, bounds.yaw_rate) == (1.0, 1.0)


def test_the_summary_says_how_far_it_came_and_why_it_ended() -> None:
    early = DriveReport("no pose comes", 3, 7.5, 150, 70, 0.4, 0.012)
    assert summary_of(early, 20, 51.0) == [
        "stopped: no pose comes; 3 of 20 moves, 7.5 of 51.0 s, 150 commands, 70 poses",
        "the robot came as near to the edge of its area as 0.40 m",
        "the command to stand was sent 12 ms after what made it stop",
    ]
    assert len(summary_of(DriveReport("", 20, 51.0, 1020, 500, math.inf, math.nan), 20, 51.0)) == 1
    assert summary_of(DriveReport("it was interrupted", 0, 0.0, 0, 0, math.inf, math.nan), 20, 51.0) == [
        "the robot was not commanded"
    ]


@pytest.mark.slow
def test_the_command_line_drives_a_robot_and_writes_what_it_did(slipwise: Slipwise, folder: Path) -> None:
    pytest.importorskip("cyclonedds")
    pytest.importorskip("mujoco", reason="simulation needs MuJoCo")
    from live.driven_robot import DrivenRobot

    from slipwise.live.wires.cyclone_wire import CycloneWire
    from slipwise.live.wires.options import WireOptions

    robot = DrivenRobot(CycloneWire(WireOptions(node_name="robot", domain=DOMAIN)))
    for _ in range(3):  # a computer that runs tests may be busy, which ends a drive
        result = slipwise(
            *("excite", "--area", "20x20", "--minutes", "0.07", "--hold", "0.5", "--pause", "0.1"),
            *("--speed", "1", "--yaw-rate", "0.5", "--radius", "1.5", "--drive", "--dead-man", "/dead_man"),
            *("--pose-topic", "/pose", "--transport", "cyclonedds", "--domain", str(DOMAIN)),
            *("--countdown", "0.2", "--json", "report.json"),
        )
        if result.code == 0:
            break
    assert result.code == 0, result.err
    assert "driven to its end; 4 of 4 moves" in result.err
    document = json.loads(Path("report.json").read_text(encoding="utf-8"))
    assert document["driven"]["why"] == ""
    assert document["driven"]["poses"] > 20
    assert open_log(Path("excite-driven.csv")).runs[0].commands is not None
    assert robot.heard[-1][1:] == (0.0, 0.0)
    robot.close()


@pytest.mark.slow
def test_lines_that_end_stop_the_drive_with_exit_code_1(
    slipwise: Slipwise, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The button is held until the robot is commanded; then its program ends."""
    begun = threading.Event()

    class Lines:
        def __iter__(self) -> Iterator[str]:
            for i in range(200):
                yield json.dumps({"t": 1.0 + 0.05 * i, "x": 0, "y": 0, "yaw": 0, "dead_man": True})
                if begun.wait(0.05):
                    return

    send = LineDriveLink.send

    def noted(link: LineDriveLink, v: float, omega: float) -> None:
        begun.set()
        send(link, v, omega)

    monkeypatch.setattr(sys, "stdin", Lines())
    monkeypatch.setattr(LineDriveLink, "send", noted)
    result = slipwise(
        *(
            "excite",
            "--area",
            "20x20",
            "--minutes",
            "0.07",
            "--hold",
            "0.5",
            "--pause",
            "0.1",
            "--speed",
            "1",
        ),
        *("--yaw-rate", "0.5", "--radius", "1.5", "--drive", "--transport", "stdin", "--countdown", "0"),
    )
    assert result.code == 1
    assert "nothing is heard of the dead man's button" in result.err
    commands = [json.loads(line) for line in result.out.splitlines()]
    assert commands
    assert (commands[-1]["cmd_v"], commands[-1]["cmd_omega"]) == (0.0, 0.0)
