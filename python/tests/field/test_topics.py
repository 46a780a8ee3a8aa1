# SPDX-License-Identifier: Apache-2.0
"""Topics in the field: of another robot, of an arm, without a twist or a rotation, in a lost file."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from sample_bags import ODOMETRY, Bag
from sample_field import (
    field_drive,
    field_path,
    learned,
    share_errors,
    write_commands,
    write_poses,
    write_wheels,
)

from slipwise.errors import LogError
from slipwise.logs import LogOptions, open_log
from slipwise.logs.bag_file import missing_files
from slipwise.logs.messages import JOINT_STATE, POSE_STAMPED, TWIST
from slipwise.logs.role_choice import Topic
from slipwise.logs.topics import choose_topics

RADIUS, SEPARATION = 0.033, 0.16  # m
POSE, COMMAND, WHEEL = ("mocap/pose", POSE_STAMPED), ("cmd_vel", TWIST), ("odom", ODOMETRY)


def chosen(*topics: tuple[str, str], pose: str | None = None, wheel: str | None = None) -> tuple[object, ...]:
    options = LogOptions(pose_topic=pose, wheel_topic=wheel)
    roles = choose_topics([Topic(*topic, 10) for topic in topics], options)
    return tuple(topic and topic.name for topic in (roles.pose, roles.command, roles.wheel))


def test_the_wheels_of_another_robot_are_not_taken() -> None:
    path = field_path("two_robots_mixed.mcap")
    log = open_log(path)
    assert log.runs[0].wheels is None
    assert "/r2/odom is not used, since it is of r2, not of r1: else give --wheel-topic /r2/odom" in log.notes
    with pytest.raises(LogError, match=r"it is of r2, not of r1: else give --wheel-topic /r2/odom"):
        learned(path, "wheel")


@pytest.mark.parametrize(
    ("own", "other"), [("r1", "r2"), ("tb3_0", "tb3_1"), ("alice", "bob"), ("a200_0001", "a300")]
)
def test_topics_of_one_robot_go_together(own: str, other: str) -> None:
    mine, others = (
        [(f"/{robot}/{name}", kind) for name, kind in (POSE, COMMAND, WHEEL)] for robot in (own, other)
    )
    names = tuple(name for name, _ in mine)
    assert chosen(*mine, others[2]) == names
    assert chosen(*mine[:2], others[2]) == (*names[:2], None)
    assert chosen(*mine, *others, pose=names[0]) == names
    with pytest.raises(LogError, match="several topics could be the"):
        chosen(*mine, *others)
    assert chosen(*mine[:2], others[2], wheel=others[2][0]) == (*names[:2], others[2][0])


def test_names_of_devices_are_no_robots() -> None:
    mixed = (("/vicon/husky/pose", POSE_STAMPED), ("/a200/cmd_vel", TWIST), ("/a200/odom", ODOMETRY))
    assert chosen(*mixed) == tuple(name for name, _ in mixed)
    drivers = (("/mocap/p", POSE_STAMPED), ("/teleop/cmd_vel", TWIST), ("/wheel/odom", ODOMETRY))
    assert chosen(*drivers) == tuple(name for name, _ in drivers)
    numbered = (("/mocap/p", POSE_STAMPED), ("/r1/cmd_vel", TWIST), ("/r2/odom", ODOMETRY))
    assert chosen(*numbered) == ("/mocap/p", "/r1/cmd_vel", None)


def test_joint_states_of_an_arm_are_left_out_and_counted() -> None:
    path = field_path("joints_arm_alternates.mcap")
    result, said = learned(path, "wheel", wheel_radius=RADIUS, wheel_separation=SEPARATION)
    assert "600 x messages of /joint_states without a wheel's joint" in said
    assert np.abs(share_errors(result.model, (0.95, 0.85))).max() < 3.0


def test_joint_states_of_an_arm_alone_are_refused_with_their_joints(tmp_path: Path) -> None:
    bag = Bag()
    write_commands(bag, field_drive(10.0))
    write_poses(bag, field_drive(10.0))
    for k in range(50):
        state = bag.joints(bag.messages[k][0], ["shoulder_pan_joint"], [0.1], [0.0])
        bag.add(bag.messages[k][0], "/joint_states", JOINT_STATE, state)
    options = LogOptions(wheel_radius=RADIUS, wheel_separation=SEPARATION)
    with pytest.raises(LogError, match=r"cannot tell left from right wheels.*joints: shoulder_pan_joint"):
        open_log(bag.write(tmp_path / "a.mcap"), options=options)


def test_the_topic_that_is_named_as_the_pose_is_no_wheel_candidate() -> None:
    path, sizes = field_path("lio_and_joints.mcap"), {"wheel_radius": RADIUS, "wheel_separation": SEPARATION}
    result, said = learned(path, "wheel", pose_topic="/Odometry", **sizes)
    assert "wheel topic: /joint_states" in said
    assert np.abs(share_errors(result.model, (0.95, 0.85))).max() < 3.0


def test_poses_of_an_odometry_stand_for_a_twist_that_is_always_zero() -> None:
    result, said = learned(field_path("wheel_twist_zero.mcap"), "wheel")
    assert "the twist of /odom is always zero though its pose moves" in said
    assert np.abs(share_errors(result.model)).max() < 3.0


def test_poses_whose_quaternions_are_no_rotations_are_positions() -> None:
    log = open_log(field_path("quat_zero_always.mcap"))
    words = "are no rotations, such as (0, 0, 0, 0): only their positions are used"
    assert any(words in note for note in log.notes)
    assert log.runs[0].poses.course
    assert len(log.runs[0].poses) == 400


def test_a_file_that_the_metadata_lists_and_is_not_there_is_said_and_begins_a_run() -> None:
    result, said = learned(field_path("split_one_lost"))
    assert "split_1.mcap, listed in metadata.yaml, is not there" in said
    assert "nothing was recorded for 25.0 s: a new run begins" in said
    assert result.verdict.good
    assert np.abs(share_errors(result.model)).max() < 3.0


def test_a_file_that_the_numbers_imply_is_said(tmp_path: Path) -> None:
    drive = field_drive(20.0)
    for part in (0, 3):
        bag = Bag()
        write_commands(bag, drive)
        write_wheels(bag, drive)
        storage = next(bag.write(tmp_path / f"b{part}.mcap").glob("*.mcap"))
        shutil.move(storage, tmp_path / f"drive_{part}.mcap")
    found = missing_files(tmp_path, sorted(tmp_path.glob("*.mcap")))
    assert [sentence.partition(",")[0] for sentence in found] == ["drive_1.mcap", "drive_2.mcap"]
