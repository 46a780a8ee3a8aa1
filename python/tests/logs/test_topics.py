# SPDX-License-Identifier: Apache-2.0
"""Tests of which topic is guessed for which role."""

import pytest

from slipwise.errors import LogError
from slipwise.logs import LogOptions
from slipwise.logs.messages import (
    ACKERMANN,
    IMU,
    JOINT_STATE,
    NAV_SAT_FIX,
    ODOMETRY,
    POSE_STAMPED,
    TF,
    TWIST,
    TWIST_STAMPED,
)
from slipwise.logs.role_choice import Topic
from slipwise.logs.topics import choose_topics, transforms_matter, weigh_topics
from slipwise.logs.transforms import TransformSource


def chosen(*topics: tuple[str, str], options: LogOptions | None = None) -> tuple[str | None, ...]:
    roles = choose_topics(live(*topics), options or LogOptions())
    return tuple(topic.name if topic else None for topic in (roles.pose, roles.command, roles.wheel))


def live(*topics: tuple[str, str]) -> list[Topic]:
    return [Topic(name, kind, 10) for name, kind in topics]


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
    assert roles.pose is not None
    assert roles.pose.name == "/odometry/filtered"
    assert any("is fused" in note for note in roles.guessed)


def test_joint_states_are_no_wheels_without_radius_and_track() -> None:
    topics = (("/cmd_vel", TWIST_STAMPED), ("/joint_states", JOINT_STATE), ("/amcl_pose", POSE_STAMPED))
    assert chosen(*topics)[2] is None
    assert chosen(*topics, options=LogOptions(wheel_radius=0.1, wheel_separation=0.5))[2] == "/joint_states"


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
        LogError, match=r"give --command-topic or --wheel-topic; the bag has /vicon/p \(PoseStamped\)"
    ):
        chosen(("/vicon/p", POSE_STAMPED))


CAR = (("/drive", ACKERMANN), ("/amcl_pose", POSE_STAMPED), ("/tf", TF))


def transforms(samples: int, *, odometry_alone: bool = False) -> TransformSource:
    return TransformSource("/tf", ("map", "base_link"), samples, odometry_alone)


def pose_of(source: TransformSource | None, *topics: tuple[str, str]) -> str:
    roles = choose_topics(live(*topics), LogOptions(), source)
    assert roles.pose is not None
    return roles.pose.name


def test_transforms_with_more_poses_replace_the_topic_of_a_localiser() -> None:
    assert pose_of(transforms(200), *CAR) == "/tf"
    assert pose_of(transforms(15), *CAR) == "/amcl_pose"
    assert pose_of(transforms(200, odometry_alone=True), *CAR) == "/amcl_pose"
    note = choose_topics(live(*CAR), LogOptions(), transforms(200)).guessed[0]
    assert note.endswith("it has more poses than /amcl_pose (200 to 10)")


@pytest.mark.parametrize("name", ["/mocap/p", "/gps/odom", "/ground_truth/pose"])
def test_a_sensor_of_its_own_is_never_replaced_by_transforms(name: str) -> None:
    topics = (("/cmd_vel", TWIST), (name, POSE_STAMPED), ("/tf", TF))
    assert pose_of(transforms(10_000), *topics) == name
    assert not transforms_matter(live(*topics), LogOptions())


def test_transforms_are_looked_at_only_where_they_matter() -> None:
    assert transforms_matter(live(*CAR), LogOptions())
    assert transforms_matter(live(("/cmd_vel", TWIST), ("/tf", TF)), LogOptions())
    assert not transforms_matter(live(*CAR[:2]), LogOptions())


def test_pose_and_wheels_from_one_topic_are_refused_with_what_to_record() -> None:
    topics = (("/cmd_vel", TWIST), ("/odom", ODOMETRY))
    with pytest.raises(LogError, match=r"both come from /odom.*record where .*RTK.*--wheel-topic none"):
        chosen(*topics, options=LogOptions(pose_topic="/odom"))
    named = LogOptions(pose_topic="/state", wheel_topic="/state")
    with pytest.raises(LogError, match="both come from /state"):
        chosen(("/state", ODOMETRY), options=named)
    assert chosen(*topics, options=LogOptions(pose_topic="/odom", wheel_topic="none")) == (
        "/odom",
        "/cmd_vel",
        None,
    )


def test_a_pose_topic_that_is_named_like_odometry_is_taken_and_pointed_out() -> None:
    options = LogOptions(pose_topic="/odom", wheel_topic="none")
    notes = choose_topics(live(("/cmd_vel", TWIST), ("/odom", ODOMETRY)), options).guessed
    assert any(
        "/odom is the pose as given, although its name says that it is wheel odometry" in n for n in notes
    )


def test_a_pose_topic_that_only_might_be_wheel_odometry_is_not_read_as_wheels() -> None:
    assert chosen(("/cmd_vel", TWIST), ("/state", ODOMETRY)) == ("/state", "/cmd_vel", None)
    with pytest.raises(LogError, match="both come from /state"):
        chosen(("/state", ODOMETRY))


def test_joint_states_without_sizes_are_named_with_the_options_to_add() -> None:
    topics = (("/cmd_vel", TWIST), ("/joint_states", JOINT_STATE), ("/vicon/p", POSE_STAMPED))
    roles = choose_topics(live(*topics), LogOptions())
    assert (
        "/joint_states has joint states: give --wheel-radius and --wheel-separation" in roles.advice["wheel"]
    )
    with pytest.raises(
        LogError, match="/joint_states has joint states: give --wheel-radius and --wheel-separation"
    ):
        chosen(*topics[1:])
    beside = choose_topics(live(*topics, ("/odom", ODOMETRY)), LogOptions())
    assert beside.advice == {}


def test_every_topic_that_is_not_used_has_a_reason() -> None:
    found = weigh_topics(live(*CLEARPATH), LogOptions())
    reasons = found.pose.rejected
    assert reasons["/move_base_simple/goal"] == "its name says that it is a goal or a plan"
    assert "cannot show its own slip" in reasons["/husky_velocity_controller/odom"]
    assert reasons["/odometry/filtered"] == "the name /icp_odom fits better"
    assert reasons["/tf"] == "/icp_odom is preferred"
    assert found.command.rejected["/cmd_vel"].startswith("the name /husky")
