# SPDX-License-Identifier: Apache-2.0
"""A simulated robot is driven over Cyclone DDS, and stands where the button, its pose or its area says so."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from live.wires.wire_messages import to_cdr

from slipwise.errors import SettingsError
from slipwise.excitation import Move
from slipwise.live.drive_guard import DriveBounds, DriveGuard
from slipwise.live.drive_ros import BOOL, JOY, DriveTopics, RosDriveLink
from slipwise.live.self_drive import DrivePlan, DriveReport, SelfDrive
from slipwise.live.wires.options import WireOptions
from slipwise.live.wires.ros_types import ros_types
from slipwise.live.wires.wire import WireTopic
from slipwise.logs import open_log
from slipwise.logs.messages import POSE_STAMPED, TWIST, TWIST_STAMPED

pytest.importorskip("cyclonedds")
pytest.importorskip("mujoco", reason="simulation needs MuJoCo")

from live.driven_robot import DrivenRobot

DOMAIN = 101 + os.getpid() % 100
TOPICS = DriveTopics(dead_man="/dead_man", pose="/pose")
HELD = {"dead_man_within": 5.0, "pose_within": 5.0}  # a computer that runs tests may be busy
FREE = DriveBounds(-5.0, 5.0, -5.0, 5.0, speed=1.0, yaw_rate=1.0, **HELD)
PLAN = DrivePlan(
    (Move(1.0, 0.5, 0.6, 0.1), Move(-1.0, -0.5, 0.6, 0.1)), lead=0.2, countdown=0.2, stand=0.2, late=5.0
)
SOON = 1.0  # s, within which the command to stand comes on any computer


class Wire:
    """Shows topics, and keeps what is published."""

    name = "a test's"

    def __init__(self, *topics: WireTopic) -> None:
        self.shown, self.published = list(topics), list[tuple[str, bytes]]()
        self.takers: dict[str, Callable[[bytes], None]] = {}
        self.listening = 1

    def topics(self) -> list[WireTopic]:
        return self.shown

    def subscribe(
        self, topic: str, _type_name: str, on_message: Callable[[bytes], None], *, latched: bool = False
    ) -> None:
        self.takers[topic] = on_message

    def publish(self, _topic: str, type_name: str, payload: bytes, *, latched: bool = False) -> None:
        self.published.append((type_name, payload))

    def advertise(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        pass

    def call(self, service: str, type_name: str, request: bytes, *, timeout: float) -> bytes | None:
        return None

    def connections(self, _topic: str) -> int:
        return self.listening

    def notices(self) -> list[str]:
        return []

    def close(self) -> None:
        pass


POSE, BUTTON = WireTopic("/pose", POSE_STAMPED, 1), WireTopic("/dead_man", BOOL, 1)


def test_it_waits_for_topics_and_for_somebody_who_listens() -> None:
    wire = Wire()
    link = RosDriveLink(wire, TOPICS)
    assert link.missing() == "topic /pose"
    wire.shown = [POSE, BUTTON]
    assert link.missing() == ""
    wire.listening = 0
    assert link.missing() == "somebody who listens on /cmd_vel"
    assert set(wire.takers) == {"/pose", "/dead_man"}


@pytest.mark.parametrize(
    ("topic", "message"),
    [
        (WireTopic("/cmd_vel", TWIST, 1), "somebody else"),
        (WireTopic("/pose", "sensor_msgs/msg/NavSatFix", 1), "NavSatFix"),
        (WireTopic("/dead_man", "std_msgs/msg/String", 1), "String"),
    ],
)
def test_what_does_not_fit_is_refused(topic: WireTopic, message: str) -> None:
    shown = {each.name: each for each in (POSE, BUTTON, topic)}
    with pytest.raises(SettingsError, match=message):
        RosDriveLink(Wire(*shown.values()), TOPICS).missing()


@pytest.mark.parametrize(("buttons", "pressed"), [([0, 1], True), ([1, 0], False), ([1], False), ([], False)])
def test_a_button_of_a_joystick_is_a_dead_man_s_button(buttons: list[int], pressed: bool) -> None:
    wire = Wire(POSE, WireTopic("/dead_man", JOY, 1))
    link = RosDriveLink(wire, DriveTopics(dead_man="/dead_man", pose="/pose", button=1))
    guard = DriveGuard(FREE)
    link.hear(guard)
    link.missing()
    types = ros_types().types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](1, 0), "")
    axes = np.zeros(0, dtype=np.float32)
    wire.takers["/dead_man"](to_cdr(JOY, header=header, axes=axes, buttons=np.array(buttons, dtype=np.int32)))
    assert guard._pressed == pressed


def test_commands_carry_the_time_where_they_are_stamped() -> None:
    wire = Wire()
    RosDriveLink(wire, DriveTopics("/dead_man", "/pose", stamped=True)).send(0.5, -0.1)
    ((kind, payload),) = wire.published
    message = ros_types().deserialize_cdr(payload, TWIST_STAMPED)
    assert kind == TWIST_STAMPED
    assert (message.twist.linear.x, message.twist.angular.z) == (0.5, -0.1)
    assert message.header.stamp.sec > 1_600_000_000


Robots = Callable[..., DrivenRobot]


@pytest.fixture
def robots() -> Iterator[Robots]:
    from slipwise.live.wires.cyclone_wire import CycloneWire

    made: list[DrivenRobot] = []

    def make(**what: int) -> DrivenRobot:
        made.append(DrivenRobot(CycloneWire(WireOptions(node_name="robot", domain=DOMAIN)), **what))
        return made[-1]

    yield make
    for robot in made:
        robot.close()


def driven(bounds: DriveBounds = FREE) -> tuple[DriveReport, RosDriveLink]:
    from slipwise.live.wires.cyclone_wire import CycloneWire

    link = RosDriveLink(CycloneWire(WireOptions(domain=DOMAIN)), TOPICS)
    try:
        return SelfDrive(link, DriveGuard(bounds), PLAN, say=print).run(), link
    finally:
        link.close()


def stands(robot: DrivenRobot) -> bool:
    return robot.heard[-1][1:] == (0.0, 0.0)


@pytest.mark.slow
def test_a_robot_drives_all_moves_and_what_it_did_is_a_log(robots: Robots, tmp_path: Path) -> None:
    robot = robots()
    report, link = driven()
    assert report.why == ""
    assert report.moves == 2
    assert stands(robot)
    file = tmp_path / "driven.csv"
    file.write_text(link.log.text(), encoding="utf-8")
    (run,) = open_log(file).runs
    assert max(run.poses.x) > 0.2  # it moved
    assert len(robot.heard) >= report.commands


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "bounds", "why"),
    [
        ({"release_at": 5}, FREE, "the dead man's button was released"),
        ({"silent_at": 5}, replace(FREE, dead_man_within=0.25), "nothing is heard of the dead man's button"),
        ({"blind_at": 5}, replace(FREE, pose_within=0.5), "no pose comes"),
    ],
)
def test_a_robot_stands_soon_after_button_or_pose_is_lost(
    robots: Robots, what: dict[str, int], bounds: DriveBounds, why: str
) -> None:
    robot = robots(**what)
    report, _ = driven(bounds)
    print(f"{why}: the command to stand came after {1e3 * robot.stood_after:.1f} ms")
    assert report.why == why
    assert robot.stood_after < SOON
    assert stands(robot)
    after = [command for t, *command in robot.heard if t > robot.acted_at + SOON]
    assert not any(any(command) for command in after)


@pytest.mark.slow
def test_a_robot_that_leaves_its_area_stands(robots: Robots) -> None:
    robot = robots()
    report, _ = driven(replace(FREE, left=-0.1, right=0.1, bottom=-0.1, top=0.1))
    assert report.why == "the robot leaves its area"
    assert report.moves == 1
    assert stands(robot)
