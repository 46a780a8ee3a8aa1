# SPDX-License-Identifier: Apache-2.0
"""Tests of which topic is guessed for which role."""

import pytest

from slipwise.errors import LogError
from slipwise.logs import LogOptions
from slipwise.logs.messages import (
    IMU,
    JOINT_STATE,
    NAV_SAT_FIX,
    ODOMETRY,
    POSE_STAMPED,
    TF,
    TWIST,
    TWIST_STAMPED,
)
from slipwise.logs.topics import Topic, choose_topics


def chosen(*topics: tuple[str, str], options: LogOptions | None = None) -> tuple[str | None, ...]:
    roles = choose_topics([Topic(name, kind, 10) for name, kind in topics], options or LogOptions())
    return tuple(topic.name if topic else None for topic in (roles.pose, roles.command, roles.wheel))


CLEARPATH = (
    ("/husky_velocity_controller/cmd_vel_out", TWIST),
    ("/cmd_vel", TWIST),
    ("/joy_teleop/cmd_vel", TWIST),
    ("/husky_velocity_controller/odom", ODOMETRY),
    ("/odometry/filtered", ODOMETRY),
    ("/icp_odom", ODOMETRY),
    ("/tf", TF),
    ("/imu/data", IMU),
    ("/move_base_simple/goal", POSE_STAMPED),
)


def test_the_command_after_limits_and_the_pose_from_outside_are_preferred() -> None:
    pose, command, wheel = chosen(*CLEARPATH)
    assert pose == "/icp_odom"
    assert command == "/husky_velocity_controller/cmd_vel_out"
    assert wheel == "/husky_velocity_controller/odom"


def test_ground_truth_comes_before_everything_else() -> None:
    assert chosen(*CLEARPATH, ("/ground_truth/pose", POSE_STAMPED))[0] == "/ground_truth/pose"


def test_a_fused_pose_is_the_last_resort_and_is_pointed_out() -> None:
    topics = [Topic(*CLEARPATH[k], 5) for k in (0, 3, 4)]
    roles = choose_topics(topics, LogOptions())
    assert roles.pose.name == "/odometry/filtered"
    assert any("is fused" in note for note in roles.guessed)


def test_joint_states_are_no_wheels_without_radius_and_track() -> None:
    topics = (("/cmd_vel", TWIST_STAMPED), ("/joint_states", JOINT_STATE), ("/amcl_pose", POSE_STAMPED))
    assert chosen(*topics)[2] is None
    assert chosen(*topics, options=LogOptions(wheel_radius=0.1, track=0.5))[2] == "/joint_states"


def test_satellite_fixes_bring_an_imu() -> None:
    names = (("/cmd_vel", TWIST), ("/fix", NAV_SAT_FIX), ("/imu/data", IMU))
    topics = [Topic(name, kind, 5) for name, kind in names]
    roles = choose_topics(topics, LogOptions())
    assert roles.imu is not None
    assert roles.imu.name == "/imu/data"


def test_empty_topics_are_not_considered() -> None:
    topics = [
        Topic("/cmd_vel_out", TWIST, 0),
        Topic("/cmd_vel", TWIST, 5),
        Topic("/vicon/p", POSE_STAMPED, 5),
    ]
    command = choose_topics(topics, LogOptions()).command
    assert command is not None
    assert command.name == "/cmd_vel"


def test_a_given_topic_of_a_wrong_type_is_refused() -> None:
    with pytest.raises(LogError, match="must be one of Twist"):
        chosen(*CLEARPATH, options=LogOptions(command_topic="/tf"))


def test_without_any_input_the_topics_are_listed() -> None:
    with pytest.raises(
        LogError, match=r"set command_topic or wheel_topic; the bag has /vicon/p \(PoseStamped\)"
    ):
        chosen(("/vicon/p", POSE_STAMPED))
