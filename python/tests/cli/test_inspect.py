# SPDX-License-Identifier: Apache-2.0
"""`slipwise inspect` shows every topic and column, and fails only on what cannot be read."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_bags import ACKERMANN, EPOCH, JOINT_STATE, POSE, SECOND, TWIST, Bag, drive_along_x

Slipwise = Callable[..., Result]


def car(bag: Bag) -> Bag:
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        drive = bag.make("ackermann_msgs/msg/AckermannDrive", 0.2, 0.0, 1.0, 0.0, 0.0)
        bag.add(stamp, "/drive", ACKERMANN, bag.make(ACKERMANN, bag.header(stamp), drive))
        bag.add(stamp, "/vicon/car", POSE, bag.make(POSE, bag.header(stamp), bag.pose(0.1 * k, 0.0, 0.0)))
    return bag


def joints_alone(bag: Bag) -> Bag:
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        bag.add(stamp, "/joint_states", JOINT_STATE, bag.joints(stamp, ["left", "right"], [0, 0], [1, 1]))
        bag.add(stamp, "/vicon/r", POSE, bag.make(POSE, bag.header(stamp), bag.pose(0.1 * k, 0.0, 0.0)))
    return bag


def commands_alone(bag: Bag) -> Bag:
    bag.add(EPOCH, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
    return bag


def two_robots(bag: Bag) -> Bag:
    drive_along_x(bag).add(EPOCH, "/robot2/cmd_vel", TWIST, bag.twist(1.0, 0.0))
    return bag


UNCLEAR = {
    "--wheelbase": car,
    "--wheel-radius and --wheel-separation": joints_alone,
    "--pose-topic, or --poses FILE": commands_alone,
    "--command-topic one of": two_robots,
}


@pytest.mark.parametrize("option", UNCLEAR)
def test_a_bag_that_can_be_read_is_never_an_error_and_the_option_is_named(
    slipwise: Slipwise, folder: Path, option: str
) -> None:
    result = slipwise("inspect", UNCLEAR[option](Bag()).write(folder / "a.mcap"))
    assert (result.code, result.err) == (0, "")
    assert re.search(f"Nothing can be learned from this yet: .*{re.escape(option)}", result.out)
    assert "Topics" in result.out
    assert slipwise("calibrate", "a", "--no-report").code == 2


def test_topics_are_listed_with_type_count_rate_use_and_reason(slipwise: Slipwise, folder: Path) -> None:
    sample = drive_along_x(Bag())
    for k in range(50):
        stamp = EPOCH + k * SECOND // 5
        state = sample.joints(stamp, ["left", "right"], [0, 0], [1, 1])
        sample.add(stamp, "/joint_states", JOINT_STATE, state)
    bag = sample.write(folder / "a.mcap")
    result = slipwise("inspect", bag)
    assert result.code == 0
    assert re.search(r"/cmd_vel +Twist +100 +10\.1 +command", result.out)
    assert re.search(r"/joint_states +JointState +50 +5\.05 +-", result.out)
    assert "Not used: /joint_states (not the wheels: its wheel speeds need --wheel-radius" in result.out
    document = slipwise("inspect", bag, "--json", "-").json
    parts = {part["name"]: part for part in document["files"][0]["parts"]}
    assert parts["/cmd_vel"]["used_as"] == "command"
    assert document["problem"] == ""


def test_a_table_with_names_of_its_own_is_shown_with_what_to_say(slipwise: Slipwise, folder: Path) -> None:
    (folder / "a.csv").write_text("time,vx\n0,1\n1,1\n")
    result = slipwise("inspect", "a.csv")
    assert result.code == 0
    assert "--columns t=time,cmd_v=vx" in result.out
    assert slipwise("inspect", "a.csv", "--json", "-").json["problem"].startswith("missing columns")


def test_what_cannot_be_read_is_an_error(slipwise: Slipwise, folder: Path) -> None:
    (folder / "a.csv").write_bytes(bytes(range(256)))
    (folder / "b.mcap").write_bytes(b"\x89MCAP0\r\n")
    for name in ("a.csv", "b.mcap", "none.bag"):
        assert slipwise("inspect", name).code == 2


@pytest.mark.slow
def test_the_drive_that_teaches_most_stands_in_place_of_advice(slipwise: Slipwise, drive_csv: Path) -> None:
    result = slipwise("inspect", drive_csv, "--excite", "next.csv")
    assert (result.code, result.err) == (0, "")
    assert "next.csv: " in result.out
    assert Path("next.csv").read_text(encoding="utf-8").startswith("t,")
    wrong = slipwise("inspect", drive_csv, "--excite", "next.csv", "--excite-area", "big")
    assert wrong.line.startswith("'big' is not an area (--excite-area)")
    unused = slipwise("inspect", drive_csv, "--excite-area", "9x9")
    assert unused.line.startswith("no drive is asked for (--excite-area): give --excite too")


def test_a_drive_that_cannot_be_designed_is_said_to_be_missing(slipwise: Slipwise, folder: Path) -> None:
    (folder / "a.csv").write_text("t,cmd_v,cmd_omega\n0,1,0\n1,1,0\n")
    result = slipwise("inspect", "a.csv", "--excite", "next.csv")
    assert (result.code, Path("next.csv").exists()) == (2, False)
    assert "next.csv is not written" in result.out
