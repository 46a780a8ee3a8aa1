# SPDX-License-Identifier: Apache-2.0
"""What a file holds is shown part by part, with what it is used as and why."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_bags import EPOCH, ODOMETRY, POSE, SECOND, TWIST, Bag, drive_along_x

from slipwise.errors import LogError
from slipwise.logs import LogOptions, Part, survey_log


def parts_of(path: Path, options: LogOptions | None = None) -> dict[str, Part]:
    return {part.name: part for part in survey_log(path, options or LogOptions()).parts}


def busy_bag(folder: Path) -> Path:
    bag = drive_along_x(Bag())
    for k in range(50):
        stamp = EPOCH + k * SECOND // 5
        bag.add(stamp, "/odom", ODOMETRY, bag.odometry(stamp, 0.0, 0.0, 0.0, v=1.0))
        bag.add(stamp, "/goal_pose", POSE, bag.make(POSE, bag.header(stamp), bag.pose(0.0, 0.0, 0.0)))
        bag.add(stamp, "/joy/cmd_vel_raw", TWIST, bag.twist(1.0, 0.0))
    return bag.write(folder / "a.mcap")


def test_every_topic_has_its_count_rate_use_and_reason(tmp_path: Path) -> None:
    parts = parts_of(busy_bag(tmp_path))
    assert {name: part.used_as for name, part in parts.items()} == {
        "/cmd_vel": "command",
        "/mocap/robot": "pose",
        "/odom": "wheel",
        "/goal_pose": "",
        "/joy/cmd_vel_raw": "",
    }
    assert parts["/cmd_vel"].count == 100
    assert parts["/cmd_vel"].rate == pytest.approx(10.0, rel=0.05)
    assert parts["/goal_pose"].why == "not the pose: its name says that it is a goal or a plan"
    assert parts["/joy/cmd_vel_raw"].why == "not the command: the name /cmd_vel fits better"
    assert all(part.why for part in parts.values())


def test_an_unclear_choice_is_no_error_but_a_reason(tmp_path: Path) -> None:
    bag = drive_along_x(Bag())
    bag.add(EPOCH, "/robot2/cmd_vel", TWIST, bag.twist(1.0, 0.0))
    parts = parts_of(bag.write(tmp_path / "a.mcap"))
    assert parts["/cmd_vel"].used_as == ""
    assert "choose with --command-topic" in parts["/cmd_vel"].why


def test_columns_of_a_table_are_shown_with_what_they_need(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(
        "t,cmd_v,cmd_steer,wheel_left,wheel_right,x,y,yaw,odo_v,fuel\n0,1,0.1,,3,0,0,0,1,9\n1,1,0.1,3,3,1,0,0,1,9\n"
    )
    parts = parts_of(path)
    assert parts["cmd_steer"].why == "a steering angle needs --wheelbase"
    assert parts["wheel_left"].why == "wheel speeds need --wheel-radius and --wheel-separation"
    assert (parts["wheel_left"].count, parts["wheel_right"].count) == (1, 2)
    assert parts["odo_v"].why == "there is no odo_omega beside it"
    assert "--columns" in parts["fuel"].why
    assert (parts["x"].used_as, parts["cmd_v"].used_as) == ("pose", "command")
    sized = parts_of(path, LogOptions(wheel_radius=0.1, wheel_separation=0.5, wheelbase=1.0))
    assert (sized["wheel_left"].used_as, sized["cmd_steer"].used_as) == ("wheel", "command")


def test_a_file_that_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="no such file"):
        survey_log(tmp_path / "none.mcap", LogOptions())
    whole = drive_along_x(Bag()).write(tmp_path / "a.mcap") / "a.mcap"
    (tmp_path / "cut.mcap").write_bytes(whole.read_bytes()[:40])
    with pytest.raises(LogError, match=r"cut off|cannot be read"):
        survey_log(tmp_path / "cut.mcap", LogOptions())
