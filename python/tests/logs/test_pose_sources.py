# SPDX-License-Identifier: Apache-2.0
"""Several sources of poses in a log: a column, files beside it, topics of a bag; fixes and gyros."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_bags import EPOCH, POSE, SECOND, TWIST, Bag

from slipwise.errors import LogError, SettingsError
from slipwise.logs import LogOptions, Run, open_log, save_log
from slipwise.logs.fixes import CODES
from slipwise.logs.gyro import gyro_alone
from slipwise.segments import pose_rows, source_names, sourced_rows

FIX, IMU = "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Imu"


def table(path: Path) -> Path:
    """A drive along x: a lidar at 10 Hz, and a receiver without headings that comes late and out of order."""
    rows = ["t,odo_v,odo_omega,x,y,yaw,source,fix"]
    late = []
    for k in range(100):
        t = 0.1 * k
        rows.append(f"{t:.2f},1,0,{t:.3f},0,0,lidar,")
        late.append(f"{t + 0.03:.2f},,,{t + 0.03:.3f},0.1,,gnss,{'none' if k == 50 else 'rtk_fixed'}")
        if k % 5 == 4:
            rows += reversed(late)
            late = []
    path.write_text("\n".join([*rows, ""]))
    return path


@pytest.mark.parametrize("yaw", ["0", ""])
def test_a_run_may_lack_a_source_that_another_has(tmp_path: Path, yaw: str) -> None:
    seen = [("a", "lidar"), ("a", "rtk"), ("b", "lidar")]
    rows = [f"{run},{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,{yaw},{name}" for k in range(20) for run, name in seen]
    (tmp_path / "a.csv").write_text("\n".join(["run,t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    first, second = open_log(tmp_path / "a.csv").runs
    assert (len(first.others["rtk"]), len(second.others["rtk"])) == (20, 0)
    assert len(second.poses) == 20


def test_each_source_holds_its_own_poses(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{k // 4},0,0,{name}" for k in range(40) for name in (("a", "b")[k % 2],)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    (run,) = open_log(tmp_path / "a.csv").runs
    assert np.allclose(run.poses.t, 0.4 * np.arange(10))
    assert np.allclose(run.others["b"].t, 0.4 * np.arange(10) + 0.1)


def test_an_empty_yaw_column_is_no_column(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0," for k in range(100)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw", *rows, ""]))
    (run,) = open_log(tmp_path / "a.csv").runs
    assert (len(run.poses), run.poses.course) == (100, True)


def test_names_of_sources_are_without_blanks_and_whole_numbers_stay_so(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,0,{('1', '', '2')[k % 3]}" for k in range(99)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    (run,) = open_log(tmp_path / "a.csv").runs
    assert (run.source, list(run.others)) == ("1", ["2"])
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,0,{('a', ' b', 'b ')[k % 3]}" for k in range(99)]
    (tmp_path / "b.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    (run,) = open_log(tmp_path / "b.csv").runs
    assert (len(run.poses), len(run.others["b"])) == (33, 66)


def test_of_several_logs_one_source_is_the_first(tmp_path: Path) -> None:
    for name, order in (("one", ("lidar", "rtk")), ("two", ("rtk", "lidar"))):
        said = [order[k % 2] for k in range(40)]
        rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},{own == 'rtk':d},0,{own}" for k, own in enumerate(said)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    runs = open_log(tmp_path / "one.csv", tmp_path / "two.csv").runs
    assert [(run.source, list(run.others)) for run in runs] == [("lidar", ["rtk"])] * 2
    assert all(not run.poses.y.any() and run.others["rtk"].y.all() for run in runs)


def test_poses_of_another_source_alone_are_not_those_of_the_first(tmp_path: Path) -> None:
    for name, own in (("one", ("lidar", "rtk")), ("two", ("rtk",))):
        rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,0,{own[k % len(own)]}" for k in range(40)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw,source", *rows, ""]))
    first, second = open_log(tmp_path / "one.csv", tmp_path / "two.csv").runs
    assert (first.source, len(first.poses), len(first.others["rtk"])) == ("lidar", 20, 20)
    assert (second.source, len(second.poses), len(second.others["rtk"])) == ("lidar", 0, 40)
    (alone,) = open_log(tmp_path / "two.csv").runs
    assert (alone.source, len(alone.poses), dict(alone.others)) == ("rtk", 40, {})
    assert source_names((alone,)) == ()


def test_a_column_says_whose_a_pose_is(tmp_path: Path) -> None:
    log = open_log(table(tmp_path / "a.csv"))
    (run,) = log.runs
    assert (run.source, list(run.others)) == ("lidar", ["gnss"])
    assert len(run.poses) == 100
    assert not run.poses.course
    gnss = run.others["gnss"]
    assert len(gnss) == 99
    assert gnss.course
    assert gnss.fix is not None
    assert set(gnss.fix.tolist()) == {CODES["rtk_fixed"]}
    assert {entry.kind: entry.count for entry in log.left_out} == {"no-fix": 1}
    assert "a.csv: poses are those of lidar, beside them gnss" in log.notes
    names = source_names(log.runs)
    assert names == ("lidar", "gnss")
    rows = sourced_rows(run, pose_rows(run.poses), names)
    assert rows.shape == (199, 9)
    assert (np.diff(rows[:, 0]) >= 0.0).all()
    cut = open_log(tmp_path / "a.csv", options=LogOptions(start=2.0, end=4.0)).runs[0]
    assert cut.others["gnss"].t[0] >= 2.0


def test_a_fix_is_kept_where_a_log_is_converted(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0,{0.1 * k:.1f},0,{4 if k < 30 else 5}" for k in range(60)]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["t,odo_v,odo_omega,x,y,fix", *rows, ""]))
    log = open_log(path)
    save_log(log, tmp_path / "b.csv")
    fixes = [open_log(each).runs[0].poses.fix for each in (path, tmp_path / "b.csv")]
    np.testing.assert_array_equal(fixes[0], fixes[1])
    assert "rtk_float" in (tmp_path / "b.csv").read_text()
    assert source_names(log.runs) == ("",)


def test_further_files_of_poses_are_sources_beside_the_first(tmp_path: Path) -> None:
    drive = tmp_path / "drive.csv"
    drive.write_text("\n".join(["t,odo_v,odo_omega", *(f"{0.1 * k:.1f},1,0" for k in range(100)), ""]))
    for name, y in (("lidar", 0.0), ("rtk", 0.1)):
        rows = [f"{0.1 * k:.1f},{0.1 * k:.2f},{y},0" for k in range(100)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["t,x,y,yaw", *rows, ""]))
    options = LogOptions(poses=tmp_path / "lidar.csv", other_poses=(tmp_path / "rtk.csv",))
    (run,) = open_log(drive, options=options).runs
    assert (run.source, list(run.others)) == ("lidar", ["rtk"])
    assert (run.poses.y[0], run.others["rtk"].y[0]) == (0.0, 0.1)
    assert tmp_path / "rtk.csv" in options.files
    (late,) = open_log(drive, options=replace(options, pose_clock_offset=0.3)).runs
    assert (late.poses.t[0], late.others["rtk"].t[0]) == (0.3, 0.3)
    with pytest.raises(SettingsError, match="need a first one"):
        LogOptions(other_poses=(tmp_path / "rtk.csv",))
    with pytest.raises(SettingsError, match="have one name"):
        LogOptions(pose_topic="/a", other_pose_topics=("/a",))


def satellite_bag(*, status: tuple[int, ...] = (0,), oriented: bool = False, turn: float = 0.2) -> Bag:
    """A drive along x with a lidar's poses, fixes and an IMU that turns by `turn` rad/s."""
    bag = Bag()
    zero = bag.vector(0.0, 0.0, 0.0)
    for k in range(100):
        stamp = EPOCH + k * SECOND // 10
        bag.add(stamp, "/cmd_vel", TWIST, bag.twist(1.0, 0.0))
        bag.add(stamp, "/lidar/pose", POSE, bag.make(POSE, bag.header(stamp), bag.pose(0.1 * k, 0.0, 0.0)))
        said = bag.make("sensor_msgs/msg/NavSatStatus", status[k % len(status)], 1)
        place = (48.0, 9.0 + 1.3447e-6 * k, 300.0)
        fix = bag.make(FIX, bag.header(stamp), said, *place, np.diag([0.04, 0.04, 0.1]).ravel(), 2)
        bag.add(stamp + 1, "/gps/fix", FIX, fix)
        q = bag.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0 if oriented else 0.0)
        none = np.zeros(9)
        rate = bag.vector(0.0, 0.0, turn if k else float("nan"))
        bag.add(
            stamp + 2, "/imu/data", IMU, bag.make(IMU, bag.header(stamp), q, none, rate, none, zero, none)
        )
    return bag


def test_further_pose_topics_of_a_bag_are_sources(tmp_path: Path) -> None:
    folder = satellite_bag(status=(0, 2)).write(tmp_path / "a.mcap")
    options = LogOptions(pose_topic="/lidar/pose", other_pose_topics=("/gps/fix",))
    (run,) = open_log(folder, options=options).runs
    assert (run.source, list(run.others)) == ("/lidar/pose", ["/gps/fix"])
    fixes = run.others["/gps/fix"]
    assert fixes.course
    assert fixes.fix is not None
    assert set(fixes.fix.tolist()) == {CODES["single"], CODES["rtk_fixed"]}
    with pytest.raises(LogError, match="/rtk is not in the bag"):
        open_log(folder, options=LogOptions(pose_topic="/lidar/pose", other_pose_topics=("/rtk",)))


def gyro_of(run: Run) -> np.ndarray:
    return np.asarray(run.extra.get("gyro_z", np.empty(0)))


def test_an_imu_without_an_orientation_is_a_gyro_beside_satellite_fixes(tmp_path: Path) -> None:
    folder = satellite_bag().write(tmp_path / "a.mcap")
    log = open_log(folder, options=LogOptions(pose_topic="/gps/fix"))
    (run,) = log.runs
    assert run.poses.course
    assert run.poses.fix is None
    np.testing.assert_array_equal(gyro_of(run), np.full(99, 0.2))
    assert {entry.kind for entry in log.left_out} >= {"no-gyro"}
    assert "yaw rates are those of /imu/data" in log.notes
    save_log(log, tmp_path / "b.csv")
    again = gyro_of(open_log(tmp_path / "b.csv").runs[0])
    np.testing.assert_array_equal(again[np.isfinite(again)], gyro_of(run))
    without = open_log(folder, options=LogOptions(pose_topic="/gps/fix", imu_topic="none"))
    assert gyro_of(without.runs[0]).size == 0


def test_where_poses_have_headings_no_gyro_is_read(tmp_path: Path) -> None:
    folder = satellite_bag(oriented=True).write(tmp_path / "a.mcap")
    assert gyro_of(open_log(folder, options=LogOptions(pose_topic="/gps/fix")).runs[0]).size == 0
    assert gyro_of(open_log(folder, options=LogOptions(pose_topic="/lidar/pose")).runs[0]).size == 0


def test_a_bag_without_poses_gives_yaw_rates_of_the_imu_that_is_named(tmp_path: Path) -> None:
    folder = satellite_bag().write(tmp_path / "a.mcap")
    (run,) = open_log(folder, options=LogOptions(pose_topic="none", imu_topic="/imu/data")).runs
    assert len(run.poses) == 0
    assert gyro_of(run).size == 99
    assert gyro_alone([run])
    with pytest.raises(LogError, match="no topic with a measured pose"):
        open_log(folder, options=LogOptions(pose_topic="none"))


def test_a_table_without_positions_needs_yaw_rates(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},1,0.1,0.1" for k in range(60)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,gyro_z", *rows, ""]))
    assert gyro_alone(open_log(tmp_path / "a.csv").runs)
    (tmp_path / "b.csv").write_text("\n".join(["t,odo_v,odo_omega,gyro_y", *rows, ""]))
    with pytest.raises(LogError, match="missing columns: x; y"):
        open_log(tmp_path / "b.csv")
