# SPDX-License-Identifier: Apache-2.0
"""Messages become the numbers that a bag's reader takes out of them."""

from __future__ import annotations

import math
from types import SimpleNamespace as Made

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.live.ros_samples import FirstPoses, FixPoses, ImuOrientation, to_command, to_pose, to_wheels
from slipwise.live.samples import Command, Pose, Wheels
from slipwise.live.stamps import Stamps, seconds_of
from slipwise.logs.messages import (
    ACKERMANN,
    JOINT_STATE,
    ODOMETRY,
    POSE_STAMPED,
    POSE_WITH_COVARIANCE,
    TWIST,
    TWIST_STAMPED,
)
from slipwise.logs.options import LogOptions


def header(t: float = 2.0, frame: str = "map") -> Made:
    return Made(stamp=Made(sec=int(t), nanosec=round((t - int(t)) * 1e9)), frame_id=frame)


def twist(v: float, vy: float, omega: float) -> Made:
    return Made(linear=Made(x=v, y=vy, z=0.0), angular=Made(x=0.0, y=0.0, z=omega))


def pose(x: float, y: float, yaw: float) -> Made:
    q = Made(x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    return Made(position=Made(x=x, y=y, z=0.0), orientation=q)


def odometry(variance: float) -> Made:
    covariance = np.zeros(36)
    covariance[[0, 7, 35]] = variance
    return Made(
        header=header(),
        pose=Made(pose=pose(1.0, 2.0, 0.5), covariance=covariance),
        twist=Made(twist=twist(0.4, 0.1, 0.2)),
    )


def test_commands_of_every_type_are_scaled() -> None:
    options = LogOptions(command_scale=(2.0, -1.0), wheelbase=2.0)
    assert to_command(TWIST, options)(twist(0.5, 0.1, 0.2), 1.0) == Command(1.0, 1.0, -0.2, 0.2)
    stamped = Made(twist=twist(0.5, 0.0, 0.2))
    assert to_command(TWIST_STAMPED, options)(stamped, 1.0) == Command(1.0, 1.0, -0.2)
    car = to_command(ACKERMANN, options)(Made(drive=Made(speed=1.0, steering_angle=0.3)), 1.0)
    assert car is not None
    assert car.v == pytest.approx(2.0)
    assert car.omega == pytest.approx(-2.0 * math.tan(0.3) / 2.0)  # of the speed as it is corrected
    with pytest.raises(SettingsError, match="--wheelbase"):
        to_command(ACKERMANN, LogOptions())


def test_an_odometry_is_wheels_or_a_pose_with_its_deviations() -> None:
    assert to_wheels(ODOMETRY, LogOptions())(odometry(0.0), 2.0) == Wheels(2.0, 0.4, 0.2, 0.1)
    found = to_pose(ODOMETRY, LogOptions(pose_yaw_offset=0.1))(odometry(0.04), 2.0)
    angle, std = pytest.approx(0.6), pytest.approx(0.2)
    assert found == Pose(2.0, 1.0, 2.0, angle, std, std, "map", z=0.0)
    unknown = to_pose(ODOMETRY, LogOptions())(odometry(0.0), 2.0)
    assert unknown is not None
    assert unknown.std_xy is None


@pytest.mark.parametrize(
    ("kind", "variance", "said"),
    [(POSE_WITH_COVARIANCE, 0.0, 1), (POSE_WITH_COVARIANCE, 0.01, 0), (ODOMETRY, 0.0, 0)],
)
def test_covariances_of_zeros_are_said_once_of_a_message_made_for_them(
    kind: str, variance: float, said: int
) -> None:
    texts: list[str] = []
    convert = to_pose(kind, LogOptions(), texts.append, "/amcl_pose")
    for k in range(50):
        convert(odometry(variance), 2.0 + k)
    assert len(texts) == said
    assert all("covariances of all 20 poses of /amcl_pose are zero" in text for text in texts)


def test_a_pose_without_a_rotation_is_said() -> None:
    wrong = Made(header=header(), pose=pose(1.0, 2.0, 0.5))
    wrong.pose.orientation.w = 7.0
    with pytest.raises(ValueError, match=r"the quaternion \(0, 0, 0.247404, 7\) is not a rotation"):
        to_pose(POSE_STAMPED, LogOptions())(wrong, 2.0)


def test_joint_states_become_a_twist_by_the_sizes_of_the_robot() -> None:
    options = LogOptions(wheel_radius=0.1, wheel_separation=0.5)
    convert = to_wheels(JOINT_STATE, options)
    names = ["left_wheel", "right_wheel"]
    found = convert(Made(name=names, velocity=[1.0, 3.0], position=[0.0, 0.0]), 1.0)
    assert found == Wheels(1.0, pytest.approx(0.2), pytest.approx(0.4))
    with pytest.raises(SettingsError, match="--wheel-radius"):
        to_wheels(JOINT_STATE, LogOptions())


def test_joints_without_speeds_are_differences_of_their_angles() -> None:
    convert = to_wheels(JOINT_STATE, LogOptions(wheel_radius=0.1, wheel_separation=0.5))
    names = ["left_wheel", "right_wheel"]
    assert convert(Made(name=names, velocity=[], position=[0.0, 0.0]), 1.0) is None
    found = convert(Made(name=names, velocity=[], position=[0.1, 0.3]), 1.1)
    assert found == Wheels(1.1, pytest.approx(0.2), pytest.approx(0.4))


def fix(latitude: float, status: int = 0) -> Made:
    return Made(
        header=header(frame="gps"),
        latitude=latitude,
        longitude=11.0,
        altitude=500.0,
        status=Made(status=status),
        position_covariance=np.diag([0.01, 0.01, 0.04]).ravel(),
        position_covariance_type=2,
    )


def test_fixes_are_poses_with_the_heading_of_an_imu_of_the_same_time() -> None:
    imu = ImuOrientation()
    fixes = FixPoses(LogOptions(), imu)
    assert fixes.take(fix(48.0), 1.0) is None  # no heading yet
    q = Made(x=0.0, y=0.0, z=math.sin(0.4), w=math.cos(0.4))
    imu.take(Made(orientation=q, orientation_covariance=np.zeros(9)), 1.9)
    found = fixes.take(fix(48.0 + 1e-5), 2.0)
    assert found is not None
    assert (found.x, found.y) == (pytest.approx(0.0, abs=1e-6), pytest.approx(1.112, abs=1e-2))
    assert found.yaw == pytest.approx(0.8)
    assert (found.roll, found.pitch) == (pytest.approx(0.0), pytest.approx(0.0))
    assert found.std_xy == pytest.approx(0.1)
    assert fixes.take(fix(48.0, status=-1), 2.0) is None
    assert fixes.take(fix(48.0), 9.0) is None  # the heading is old


def attitude_of(found: Pose | None) -> tuple[float | None, float | None]:
    assert found is not None
    return found.roll, found.pitch


def tilted(roll: float) -> Made:
    return Made(x=math.sin(roll / 2.0), y=0.0, z=0.0, w=math.cos(roll / 2.0))


def test_planar_poses_have_roll_and_pitch_of_an_imu_of_the_same_time_and_poses_in_space_their_own() -> None:
    imu = ImuOrientation()
    planar, spatial = (
        to_pose(POSE_STAMPED, LogOptions(), seen=FirstPoses(attitude=True, tilts=tilts), imu=imu)
        for tilts in (False, True)
    )
    level, leaning = (
        Made(header=header(), pose=Made(position=Made(x=1.0, y=2.0, z=0.0), orientation=tilted(roll)))
        for roll in (0.0, 0.3)
    )
    assert attitude_of(planar(level, 1.0)) == (None, None)
    imu.take(Made(orientation=tilted(0.1), orientation_covariance=np.zeros(9)), 1.9)
    assert attitude_of(planar(level, 2.0)) == (pytest.approx(0.1), pytest.approx(0.0))
    assert attitude_of(spatial(leaning, 2.0)) == (pytest.approx(0.3), pytest.approx(0.0))
    assert attitude_of(planar(level, 2.2)) == (None, None)  # that of the IMU is old


def test_fixes_without_an_imu_are_positions() -> None:
    fixes = FixPoses(LogOptions(), None)
    first, second = fixes.take(fix(48.0), 1.0), fixes.take(fix(48.0 + 1e-5), 2.0)
    assert first is not None
    assert second is not None
    assert math.isnan(second.yaw)
    assert second.y - first.y == pytest.approx(1.112, abs=1e-2)
    assert second.std_xy == pytest.approx(0.1)
    assert fixes.take(fix(48.0, status=-1), 3.0) is None


def test_stamps_are_those_of_headers_and_others_are_dated_by_their_clock() -> None:
    stamps, no_header = Stamps(), twist(1.0, 0.0, 0.0)
    assert stamps.of(no_header, 1000.0) == 1000.0
    for k in range(50):  # headers of a clock that is 700 s behind, delivered 10 to 59 ms late
        assert stamps.of(Made(header=header(300.0 + k)), 1000.01 + k + 0.001 * k) == 300.0 + k
    assert stamps.of(no_header, 1100.0) == pytest.approx(399.99)
    assert stamps.of(no_header, 1100.0, "/cmd_vel") == pytest.approx(399.99)
    stamps.simulated = True
    stamps.take_clock(Made(sec=12, nanosec=500_000_000))
    assert stamps.of(no_header, 1100.0) == 12.5


def heard(stamps: Stamps, topic: str, ahead: float, begin: float = 1000.0) -> list[float]:
    """Take 50 messages of a topic whose clock is ahead, 10 to 59 ms late; return how they are dated."""
    times = [begin + 0.1 * k for k in range(50)]
    made = [Made(header=Made(stamp=Made(sec=0, nanosec=round(1e9 * (t + ahead))))) for t in times]
    return [
        stamps.of(message, t + 0.01 + 0.001 * k, topic) - t
        for k, (message, t) in enumerate(zip(made, times, strict=True))
    ]


@pytest.mark.parametrize("ahead", [1.7, -1.7, 0.3])
def test_a_small_offset_of_clocks_is_seen_live_as_in_a_bag(ahead: float) -> None:
    said: list[str] = []
    stamps, no_header = Stamps("/pose", said.append), twist(1.0, 0.0, 0.0)
    heard(stamps, "/pose", ahead)
    assert stamps.of(no_header, 1010.0, "/cmd_vel") == pytest.approx(1010.0 + ahead, abs=0.02)
    side = "ahead of" if ahead > 0.0 else "behind"
    assert len(said) == 1
    assert said[0].endswith(f"{side} this computer's: messages without a header get their clock")
    assert heard(stamps, "/odom", 0.0)[-1] == pytest.approx(ahead, abs=0.02)
    assert said[1].startswith("the clock of /odom is not that of the poses")


def test_clocks_are_compared_once_the_headers_of_every_topic_follow_their_arrival() -> None:
    stamps = Stamps("/pose")
    assert not stamps.compared
    heard(stamps, "/pose", 1.7)
    assert stamps.compared
    stamps.of(Made(header=header(1004.0)), 1005.0, "/cmd")  # too few to tell
    assert not stamps.compared
    heard(stamps, "/cmd", 0.0, 1005.0)
    assert stamps.compared
    for k in range(50):  # stamps that follow no clock
        stamps.of(Made(header=header(1010.0)), 1010.0 + 0.2 * k, "/odom")
    assert not stamps.compared


def test_a_clock_that_is_set_dates_what_has_no_header_anew() -> None:
    stamps, no_header = Stamps("/pose"), twist(1.0, 0.0, 0.0)
    heard(stamps, "/pose", 0.0)
    heard(stamps, "/pose", -10.0, 1005.0)
    assert stamps.of(no_header, 1010.0, "/cmd_vel") == pytest.approx(1000.0, abs=0.02)


@pytest.mark.parametrize("rate", [0.5, 0.8, 10.0])
def test_simulated_time_at_another_rate_is_followed_live(rate: float) -> None:
    stamps, no_header = Stamps("/pose"), twist(1.0, 0.0, 0.0)
    for k in range(400):
        arrived = 1000.0 + 0.02 * k
        seconds = 12.0 + rate * 0.02 * k
        for topic in ("/pose", "/odom")[: 1 + k % 2]:
            message = Made(header=Made(stamp=Made(sec=0, nanosec=round(1e9 * seconds))))
            assert stamps.of(message, arrived, topic) == pytest.approx(seconds)
        if k > 150:
            assert stamps.of(no_header, arrived, "/cmd_vel") == pytest.approx(
                seconds, abs=0.31 * max(rate, 1.0)
            )


def test_stamps_are_rounded_as_those_of_a_bag() -> None:
    rng = np.random.default_rng(1)
    stamps = [*rng.integers(0, 2**31 * 10**9, 500).tolist(), *rng.integers(0, 300 * 10**9, 500).tolist()]
    of_bag = (np.array(stamps, dtype=np.int64) / 1e9).tolist()
    halves = [divmod(stamp, 10**9) for stamp in stamps]
    assert [seconds_of(Made(sec=s, nanosec=ns)) for s, ns in halves] == of_bag
    assert [s + ns / 1e9 for s, ns in halves] != of_bag  # the simpler sum is rounded otherwise
