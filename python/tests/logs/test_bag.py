# SPDX-License-Identifier: Apache-2.0
"""Tests of reading bags: formats, message types, topics, stamps and damage."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg
from sample_bags import EPOCH, ODOMETRY, POSE, SECOND, TWIST, Bag, drive_along_x

from slipwise.errors import LogError
from slipwise.logs import Log, LogOptions, open_log
from slipwise.logs.messages import ACKERMANN, TF
from slipwise.logs.rotation import quaternions_of


def counts(log: Log) -> dict[str, int]:
    return {entry.kind: entry.count for entry in log.left_out}


@pytest.mark.parametrize("name", ["a.mcap", "a.db3", "a.bag"])
def test_every_format_reads_the_same(tmp_path: Path, name: str) -> None:
    path = drive_along_x(Bag(ros1=name.endswith(".bag"))).write(tmp_path / name)
    log = open_log(path)
    (run,) = log.runs
    assert run.commands is not None
    assert run.wheels is None
    np.testing.assert_allclose(run.poses.x, 0.1 * np.arange(100), atol=1e-12)
    np.testing.assert_allclose(run.poses.yaw, 0.5, atol=1e-12)
    np.testing.assert_allclose(run.commands.t, EPOCH / 1e9 + 0.1 * np.arange(100), atol=1e-6)
    assert run.commands.v.tolist() == [1.0] * 100
    assert run.poses.std_xy is None
    assert "pose topic: /mocap/robot (geometry_msgs/PoseStamped)" in log.notes
    assert log.sources[0].rows == 200
    assert log.left_out == ()


@pytest.mark.parametrize("name", ["a.mcap", "a.db3"])
@pytest.mark.parametrize("renamed", ["bare", "bare.dat"])
def test_a_storage_file_opens_without_metadata(tmp_path: Path, name: str, renamed: str) -> None:
    folder = drive_along_x(Bag()).write(tmp_path / name)
    bare = tmp_path / (renamed + Path(name).suffix if renamed == "bare" else renamed)
    shutil.copy(folder / name, bare)
    assert len(open_log(bare).runs[0].poses) == 100


def test_a_folder_without_metadata_opens(tmp_path: Path) -> None:
    folder = drive_along_x(Bag()).write(tmp_path / "a.mcap")
    (folder / "metadata.yaml").unlink()
    assert len(open_log(folder).runs[0].poses) == 100


def test_a_folder_without_a_bag_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="the folder holds no bag"):
        open_log(tmp_path)


@pytest.mark.parametrize("name", ["a.mcap", "a.db3", "a.bag"])
def test_wrong_magic_bytes_and_empty_files_are_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"PK\x03\x04 this is something else")
    with pytest.raises(LogError, match="wrong magic"):
        open_log(tmp_path / name)
    (tmp_path / name).write_bytes(b"")
    with pytest.raises(LogError, match="the file is empty"):
        open_log(tmp_path / name)


def cut(source: Path, target: Path, part: float) -> Path:
    content = source.read_bytes()
    target.write_bytes(content[: int(part * len(content))])
    return target


def opened_or_refused(path: Path) -> tuple[Log, LogError | None]:
    try:
        return open_log(path), None
    except LogError as error:
        return Log(runs=()), error


@pytest.mark.slow
@pytest.mark.parametrize("part", [0.5, 0.9, 0.99])
def test_a_cut_off_mcap_is_read_as_far_as_it_goes_and_counted(tmp_path: Path, part: float) -> None:
    folder = drive_along_x(Bag(), count=20_000).write(tmp_path / "a.mcap")
    log = open_log(cut(folder / "a.mcap", tmp_path / "cut.mcap", part))
    assert 100 < len(log.runs[0].poses) <= 20_000
    assert counts(log)["damaged-bag"] >= 1


@pytest.mark.parametrize("part", [0.02, 0.4, 0.9])
@pytest.mark.parametrize("name", ["a.db3", "a.bag"])
def test_a_cut_off_bag_is_read_in_part_or_refused_in_one_line(tmp_path: Path, name: str, part: float) -> None:
    path = drive_along_x(Bag(ros1=name == "a.bag"), count=2000).write(tmp_path / name)
    whole = path / name if path.is_dir() else path
    log, error = opened_or_refused(cut(whole, tmp_path / f"cut{whole.suffix}", part))
    if error is not None:
        assert "\n" not in str(error)
        assert error.where
        assert error.advice
    else:
        assert counts(log)["damaged-bag"] >= 1


def test_zero_stamps_are_replaced_by_the_time_of_receipt_and_counted(tmp_path: Path) -> None:
    bag = Bag()
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        header = 0 if k < 5 else stamp
        bag.add(
            stamp,
            "/cmd_vel",
            "geometry_msgs/msg/TwistStamped",
            bag.make("geometry_msgs/msg/TwistStamped", bag.header(stamp), bag.twist(1.0, 0.0)),
        )
        bag.add(stamp, "/vicon/p", POSE, bag.make(POSE, bag.header(header), bag.pose(0.1 * k, 0.0, 0.0)))
    log = open_log(bag.write(tmp_path / "a.mcap"))
    assert counts(log) == {"zero-stamp": 5}
    np.testing.assert_allclose(np.diff(log.runs[0].poses.t), 0.1, atol=1e-6)


def test_headers_on_another_clock_are_not_mixed_with_the_time_of_receipt(tmp_path: Path) -> None:
    bag = Bag()
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        bag.add(stamp, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
        simulated = k * SECOND // 10 + 1
        bag.add(stamp, "/vicon/p", POSE, bag.make(POSE, bag.header(simulated), bag.pose(0.1 * k, 0.0, 0.0)))
    log = open_log(bag.write(tmp_path / "a.mcap"))
    assert any("another clock" in note for note in log.notes)
    run = log.runs[0]
    assert run.commands is not None
    np.testing.assert_allclose(run.poses.t, run.commands.t, atol=1e-6)


def test_a_bad_quaternion_is_left_out_and_counted(tmp_path: Path) -> None:
    bag = drive_along_x(Bag())
    for _, _, kind, message in bag.messages[20:28]:
        if kind == POSE:
            message.pose.orientation.w = 0.0
    log = open_log(bag.write(tmp_path / "a.mcap"))
    assert counts(log) == {"bad-quaternion": 4}
    assert len(log.runs[0].poses) == 96


def test_wheel_odometry_is_the_wheels_and_never_the_pose(tmp_path: Path) -> None:
    bag = Bag()
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        bag.add(
            stamp,
            "/husky_velocity_controller/odom",
            ODOMETRY,
            bag.odometry(stamp, 0.0, 0.0, 0.0, v=0.5, omega=0.1),
        )
    folder = bag.write(tmp_path / "a.mcap")
    with pytest.raises(LogError, match="looks like wheel odometry"):
        open_log(folder)
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        bag.add(stamp, "/icp_odom", ODOMETRY, bag.odometry(stamp, 0.05 * k, 0.0, 0.0))
    run = open_log(bag.write(tmp_path / "b.mcap")).runs[0]
    assert run.wheels is not None
    assert (run.wheels.v[0], run.wheels.omega[0]) == (0.5, 0.1)
    assert run.poses.x[-1] == pytest.approx(0.05 * 49)


def test_a_car_needs_its_wheelbase(tmp_path: Path) -> None:
    bag = Bag()
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        drive = bag.make("ackermann_msgs/msg/AckermannDrive", 0.2, 0.0, 1.0, 0.0, 0.0)
        bag.add(stamp, "/drive", ACKERMANN, bag.make(ACKERMANN, bag.header(stamp), drive))
        bag.add(stamp, "/pf/pose", POSE, bag.make(POSE, bag.header(stamp), bag.pose(0.1 * k, 0.0, 0.0)))
    folder = bag.write(tmp_path / "a.mcap")
    with pytest.raises(LogError, match="wheelbase"):
        open_log(folder)
    commands = open_log(folder, options=LogOptions(wheelbase=0.32)).runs[0].commands
    assert commands is not None
    assert commands.omega[0] == pytest.approx(np.tan(np.float32(0.2)) / 0.32, rel=1e-6)


def test_joint_states_give_wheels_with_radius_and_track(tmp_path: Path) -> None:
    bag = drive_along_x(Bag())
    names = ["front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel", "arm_pan"]
    for k in range(100):
        stamp = EPOCH + k * SECOND // 10
        speeds = np.array([2.0, 4.0, 2.0, 4.0, 9.0])
        state = bag.make(
            "sensor_msgs/msg/JointState", bag.header(stamp), names, np.zeros(5), speeds, np.zeros(5)
        )
        bag.add(stamp, "/joint_states", "sensor_msgs/msg/JointState", state)
    folder = bag.write(tmp_path / "a.mcap")
    assert open_log(folder).runs[0].wheels is None
    wheels = open_log(folder, options=LogOptions(wheel_radius=0.1, wheel_separation=0.5)).runs[0].wheels
    assert wheels is not None
    assert wheels.v[0] == pytest.approx(0.3)
    assert wheels.omega[0] == pytest.approx(0.4)


def test_two_equal_candidates_are_listed(tmp_path: Path) -> None:
    bag = drive_along_x(Bag())
    for k in range(10):
        bag.add(EPOCH + k, "/robot2/cmd_vel", TWIST, bag.twist(1.0, 0.0))
    folder = bag.write(tmp_path / "a.mcap")
    with pytest.raises(LogError, match=r"give --command-topic one of .*/cmd_vel.*/robot2/cmd_vel"):
        open_log(folder)
    commands = open_log(folder, options=LogOptions(command_topic="/cmd_vel")).runs[0].commands
    assert commands is not None
    assert len(commands) == 100


def test_a_given_topic_that_is_not_there_is_refused_with_those_that_are(tmp_path: Path) -> None:
    folder = drive_along_x(Bag()).write(tmp_path / "a.mcap")
    with pytest.raises(LogError, match=r"--pose-topic /gps is not in the bag.*/mocap/robot"):
        open_log(folder, options=LogOptions(pose_topic="/gps"))


def test_topics_of_unknown_types_are_not_in_the_way(tmp_path: Path) -> None:
    bag = drive_along_x(Bag())
    bag.store.register(get_types_from_msg("float64 secret\n", "my_robot/msg/Odd"))
    bag.add(EPOCH, "/odd", "my_robot/msg/Odd", bag.make("my_robot/msg/Odd", 1.0))
    assert len(open_log(bag.write(tmp_path / "a.mcap")).runs[0].poses) == 100


def test_satellite_fixes_get_their_heading_from_the_track(tmp_path: Path) -> None:
    bag = Bag()
    status = bag.make("sensor_msgs/msg/NavSatStatus", 0, 1)
    none = bag.make("sensor_msgs/msg/NavSatStatus", -1, 1)
    for k in range(60):
        stamp = EPOCH + k * SECOND // 5
        bag.add(stamp, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
        place = (48.0 + 1e-6 * 1.8 * k, 9.0, 300.0)  # 0.2 m north a step
        fix = bag.make(
            "sensor_msgs/msg/NavSatFix",
            bag.header(stamp),
            none if k == 30 else status,
            *place,
            np.diag([0.04, 0.04, 0.1]).ravel(),
            2,
        )
        bag.add(stamp, "/gps/fix", "sensor_msgs/msg/NavSatFix", fix)
    log = open_log(bag.write(tmp_path / "a.mcap"))
    poses = log.runs[0].poses
    np.testing.assert_allclose(poses.yaw, 0.5 * np.pi, atol=1e-3)
    assert poses.y[-1] - poses.y[0] == pytest.approx(59 * 0.2002, rel=0.001)
    assert poses.std_xy is not None
    assert poses.std_xy[0] == pytest.approx(0.2)
    assert counts(log)["no-fix"] == 1


@pytest.mark.parametrize("name", ["a.mcap", "a.bag"])
def test_poses_come_from_a_chain_of_transforms(tmp_path: Path, name: str) -> None:
    bag = Bag(ros1=name == "a.bag")
    bag.add(EPOCH, "/tf_static", TF, bag.transform(EPOCH, "base_link", "lidar", (9.0, 0.0, 0.0)))
    for k in range(50):
        stamp = EPOCH + k * SECOND // 10
        bag.add(stamp, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
        bag.add(stamp, "/tf", TF, bag.transform(stamp, "map", "odom", (1.0, 0.0, 0.5 * np.pi)))
        bag.add(stamp, "/tf", TF, bag.transform(stamp, "odom", "base_link", (0.1 * k, 0.0, 0.0)))
    folder = bag.write(tmp_path / name)
    log = open_log(folder)
    poses = log.runs[0].poses
    np.testing.assert_allclose(poses.x, 1.0, atol=1e-9)
    np.testing.assert_allclose(poses.y, 0.1 * np.arange(50), atol=1e-9)
    np.testing.assert_allclose(poses.yaw, 0.5 * np.pi, atol=1e-9)
    assert "poses are the transform map -> base_link" in log.notes
    with pytest.raises(LogError, match="TF does not connect world to base_link"):
        open_log(folder, options=LogOptions(pose_frame="world", child_frame="base_link"))


def test_a_bag_with_nothing_in_it_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="the bag has no messages"):
        open_log(Bag().write(tmp_path / "a.mcap"))


def test_planar_poses_take_roll_and_pitch_of_an_imu_that_is_named(tmp_path: Path) -> None:
    bag, kind, none = drive_along_x(Bag()), "sensor_msgs/msg/Imu", np.zeros(9)
    for k in range(100):
        stamp = EPOCH + k * SECOND // 10
        x, y, z, w = quaternions_of(np.array([0.1]), np.array([-0.002 * k]), np.array([1.0]))[0].tolist()
        turned, still = bag.make("geometry_msgs/msg/Quaternion", x, y, z, w), bag.vector(0.0, 0.0, 0.0)
        message = bag.make(kind, bag.header(stamp), turned, none, still, none, still, none)
        bag.add(stamp, "/imu/data", kind, message)
    path = bag.write(tmp_path / "a.mcap")
    poses = open_log(path, options=LogOptions(imu_topic="/imu/data")).runs[0].poses
    assert poses.roll == pytest.approx(np.full(100, 0.1))
    assert poses.pitch == pytest.approx(-0.002 * np.arange(100))
    assert poses.yaw == pytest.approx(np.full(100, 0.5))
    assert open_log(path).runs[0].poses.roll is None
