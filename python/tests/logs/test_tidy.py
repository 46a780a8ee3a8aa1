# SPDX-License-Identifier: Apache-2.0
"""Tests of reading tidy tables, good and bad."""

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from slipwise import _core
from slipwise.errors import LogError, SettingsError
from slipwise.logs import Log, LogOptions, open_log

HEADER = "t,cmd_v,cmd_omega,x,y,yaw,pose_new"


def table(tmp_path: Path, *lines: str, header: str = HEADER, name: str = "a.csv") -> Path:
    path = tmp_path / name
    path.write_text("\n".join((header, *lines)) + "\n", encoding="utf-8")
    return path


def counts(log: Log) -> dict[str, int]:
    return {entry.kind: entry.count for entry in log.left_out}


def test_cells_of_spaces_are_empty_as_they_are_in_lines(tmp_path: Path) -> None:
    rows = ["0,  1.0, 0.5,          , ,", " 0.1, ,     , 0.1, 0.2,  NA", "0.2, 1.0, 0.5, 0.3, 0.2, 0"]
    (run,) = open_log(table(tmp_path, *rows, header="t,cmd_v,cmd_omega,x,y,yaw")).runs
    assert run.commands is not None
    np.testing.assert_array_equal(run.commands.t, [0.0, 0.2])
    np.testing.assert_array_equal(run.poses.t, [0.2])


def test_empty_cells_are_no_measurement_and_not_counted(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0.5,,,,0", "0.1,,,0,0,0,1", "0.2,2,0,,,,0", "0.3,,,0.1,0,0,1"))
    (run,) = log.runs
    assert run.commands is not None
    assert run.commands.t.tolist() == [0.0, 0.2]
    assert run.poses.t.tolist() == [0.1, 0.3]
    assert log.left_out == ()
    assert run.name == "a"


def test_held_poses_are_not_taken_as_fresh(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,1", "0.1,1,0,0,0,0,0", "0.2,1,0,0.2,0,0,1"))
    assert log.runs[0].poses.t.tolist() == [0.0, 0.2]


def test_a_pose_of_which_nobody_says_whether_it_is_new_is_counted(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,1", "0.1,1,0,0.1,0,0,", "0.2,1,0,,,,", "0.3,1,0,0.3,0,0,1"))
    assert log.runs[0].poses.t.tolist() == [0.0, 0.3]
    assert counts(log) == {"unsaid": 1}


def test_without_pose_new_a_repeated_pose_is_held(tmp_path: Path) -> None:
    header = "t,cmd_v,cmd_omega,x,y,yaw"
    log = open_log(table(tmp_path, "0,1,0,0,0,0", "0.1,1,0,0,0,0", "0.2,1,0,0.2,0,0", header=header))
    assert log.runs[0].poses.t.tolist() == [0.0, 0.2]
    assert any("1 rows that repeat" in note for note in log.notes)


@pytest.mark.parametrize("bad", ["nan", "NaN", "inf", "-inf"])
def test_cells_that_are_not_finite_are_counted(tmp_path: Path, bad: str) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,1", f"0.1,1,0,{bad},0,0,1", "0.2,1,0,0.2,0,0,1"))
    entry = log.left_out[0]
    assert (entry.kind, entry.count, entry.where) == ("non-finite", 1, "a.csv, line 3")
    assert "x" in entry.reason
    assert counts(log)["incomplete"] == 1
    assert len(log.runs[0].poses) == 2


def test_duplicate_and_backward_stamps_are_counted_with_their_place(tmp_path: Path) -> None:
    rows = ["0,1,0,0,0,0,1", "0.1,1,0,0,0,0,0", "0.1,1,0,0,0,0,0", "0.05,1,0,0,0,0,0", "0.2,1,0,0.1,0,0,1"]
    log = open_log(table(tmp_path, *rows))
    places = {entry.kind: entry.where for entry in log.left_out}
    assert counts(log) == {"duplicate-stamp": 1, "backward-stamp": 1}
    assert places == {"duplicate-stamp": "a.csv, line 4", "backward-stamp": "a.csv, line 5"}


def test_rows_of_a_run_need_not_be_together(tmp_path: Path) -> None:
    header = f"run,{HEADER}"
    rows = ["b,0,1,0,0,0,0,1", "a,0,2,0,5,0,0,1", "b,0.1,1,0,0.1,0,0,1", "a,0.1,2,0,5.2,0,0,1"]
    log = open_log(table(tmp_path, *rows, header=header))
    assert [run.name for run in log.runs] == ["b", "a"]
    assert log.runs[1].poses.x.tolist() == [5.0, 5.2]


def test_frames_are_numbered_as_they_appear(tmp_path: Path) -> None:
    rows = ["7,0,1,0,0,0,0,1", "7,0.1,1,0,0.1,0,0,1", "3,0.2,1,0,9,0,0,1", "7,0.3,1,0,0.2,0,0,1"]
    log = open_log(table(tmp_path, *rows, header=f"frame,{HEADER}"))
    assert log.runs[0].poses.frame.tolist() == [0, 0, 1, 0]


def test_other_columns_are_carried_along(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,1,wet grass,3", header=f"{HEADER},terrain,lux"))
    extra = log.runs[0].extra
    assert extra["terrain"].tolist() == ["wet grass"]
    assert extra["lux"].tolist() == [3]
    assert extra["t"].tolist() == [0.0]


def test_wheel_speeds_need_radius_and_track(tmp_path: Path) -> None:
    path = table(tmp_path, "0,2,4,0,0,0", "0.1,2,4,0,0,0", header="t,wheel_left,wheel_right,x,y,yaw")
    with pytest.raises(LogError, match="--wheel-radius and --wheel-separation"):
        open_log(path)
    wheels = open_log(path, options=LogOptions(wheel_radius=0.5, wheel_separation=2.0)).runs[0].wheels
    assert wheels is not None
    assert (wheels.v[0], wheels.omega[0]) == (1.5, 0.5)


def test_steering_gives_omega_with_a_wheelbase(tmp_path: Path) -> None:
    path = table(tmp_path, "0,2,0.1,0,0,0", header="t,cmd_v,cmd_steer,x,y,yaw")
    with pytest.raises(LogError, match=r"cmd_omega.*wheelbase"):
        open_log(path)
    commands = open_log(path, options=LogOptions(wheelbase=0.5)).runs[0].commands
    assert commands is not None
    assert commands.omega[0] == pytest.approx(2.0 * math.tan(0.1) / 0.5, rel=1e-14)
    assert commands.wheelbase == 0.5


def test_a_wheelbase_of_a_robot_that_is_commanded_sideways_is_refused(tmp_path: Path) -> None:
    path = table(tmp_path, "0,1,0.5,0.1,0,0,0", header="t,cmd_v,cmd_vy,cmd_omega,x,y,yaw")
    with pytest.raises(LogError, match="commands drive the robot sideways, and a wheelbase is of one that"):
        open_log(path, options=LogOptions(wheelbase=0.5))


def test_a_car_that_stands_with_turned_wheels_has_their_curvature_in_its_commands(tmp_path: Path) -> None:
    rows = ["0,0,0.1,0,0,0", "0.1,0,0,0,0,0", "0.2,-1,0.1,0,0,0"]
    path = table(tmp_path, *rows, header="t,cmd_v,cmd_steer,x,y,yaw")
    commands = open_log(path, options=LogOptions(wheelbase=0.5)).runs[0].commands
    assert commands is not None
    assert commands.v.tolist() == [_core.STANDING_SPEED, 0.0, -1.0]
    assert commands.omega[[0, 2]] / commands.v[[0, 2]] == pytest.approx(np.full(2, math.tan(0.1) / 0.5))
    path = table(
        tmp_path, "0,0,0,0.1,0,0,0", "0.1,2,0.3,0.1,0,0,0", header="t,cmd_v,cmd_omega,cmd_steer,x,y,yaw"
    )
    both = open_log(path, options=LogOptions(wheelbase=0.5)).runs[0].commands
    assert both is not None
    assert both.v.tolist() == [_core.STANDING_SPEED, 2.0]
    assert both.omega.tolist() == [commands.omega[0], 0.3]


def test_a_commanded_curvature_is_a_yaw_rate_at_the_commanded_speed(tmp_path: Path) -> None:
    rows = ["0,2,0.25,0,0,0", "0.1,-1,0.25,0,0,0", "0.2,0,0.25,0,0,0"]
    log = open_log(table(tmp_path, *rows, header="t,cmd_v,cmd_curvature,x,y,yaw"))
    commands = log.runs[0].commands
    assert commands is not None
    assert commands.omega.tolist() == [0.5, -0.25, 0.0]
    assert any("cmd_omega from cmd_curvature" in note for note in log.notes)


def test_a_commanded_yaw_rate_counts_before_a_curvature(tmp_path: Path) -> None:
    rows = ["0,2,0.3,0.25,0,0,0", "0.1,2,,0.25,0,0,0"]
    commands = (
        open_log(table(tmp_path, *rows, header="t,cmd_v,cmd_omega,cmd_curvature,x,y,yaw")).runs[0].commands
    )
    assert commands is not None
    assert commands.omega.tolist() == [0.3, 0.5]


def test_a_curvature_without_a_speed_is_no_command(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="missing columns: cmd_v, the speed that cmd_curvature is driven at"):
        open_log(table(tmp_path, "0,0.25,0,0,0", header="t,cmd_curvature,x,y,yaw"))
    header = "t,cmd_curvature,odo_v,odo_omega,x,y,yaw"
    log = open_log(table(tmp_path, "0,0.25,1,0,0,0,0", "0.1,0.25,1,0,0.1,0,0", header=header))
    assert log.runs[0].commands is None
    assert any("cmd_curvature has no cmd_v beside it" in note for note in log.notes)


def test_sideways_commands_of_an_omnidirectional_robot(tmp_path: Path) -> None:
    commands = (
        open_log(table(tmp_path, "0,1,0.5,0,0,0,0", header="t,cmd_v,cmd_vy,cmd_omega,x,y,yaw"))
        .runs[0]
        .commands
    )
    assert commands is not None
    assert commands.vy.tolist() == [0.5]


def test_a_speed_along_the_direction_of_travel_is_not_added_to(tmp_path: Path) -> None:
    header = "t,cmd_v,cmd_vx,cmd_vy,cmd_omega,x,y,yaw"
    log = open_log(table(tmp_path, "0,0.5,0.3,0.4,0,0,0,0", header=header))
    commands = log.runs[0].commands
    assert commands is not None
    assert (commands.v[0], commands.vy[0]) == (0.5, 0.0)
    assert any("direction of travel" in note for note in log.notes)


def test_missing_columns_are_named_with_those_found(tmp_path: Path) -> None:
    with pytest.raises(LogError) as caught:
        open_log(table(tmp_path, "0,1", header="time,speed"))
    message = str(caught.value)
    assert "missing columns: t; x; y; cmd_v and cmd_omega" in message
    assert "found time, speed" in message
    assert "\n" not in message


def test_hopeless_files_are_refused_in_one_line(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for content, expected in [
        (b"", "the file is empty"),
        (b"t;x;y\n0,5;1;2\n", "not separated by commas"),
        (b"\x00\x01\x02\x03binary", "not a text file"),
        (HEADER.encode() + b"\n", "no rows"),
        (b"t,t,x,y,yaw,cmd_v,cmd_omega\n0,0,0,0,0,0,0\n", "column t is there twice"),
        (HEADER.encode() + b"\n0,fast,0,0,0,0,1\n", "column cmd_v: .*must be a number"),
    ]:
        with subtests.test(content=content, expected=expected):
            path = tmp_path / "a.csv"
            path.write_bytes(content)
            with pytest.raises(LogError, match=expected) as caught:
                open_log(path)
            assert "\n" not in str(caught.value)


def test_a_cut_off_gzip_file_is_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    rows = "\n".join(f"{i / 10},{rng.random()},0,0,0,0,1" for i in range(2000))
    path = tmp_path / "a.csv.gz"
    path.write_bytes(gzip.compress(f"{HEADER}\n{rows}\n".encode())[:-5000])
    with pytest.raises(LogError, match="cut off or damaged"):
        open_log(path)


def test_rows_with_missing_cells_are_counted(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,1", "0.1,1,0,0.1,0,0,1", "0.2,1"))
    assert counts(log) == {"broken-row": 1}


def test_pose_new_may_be_true_or_false(tmp_path: Path) -> None:
    log = open_log(table(tmp_path, "0,1,0,0,0,0,True", "0.1,1,0,0.1,0,0,False", "0.2,1,0,0.2,0,0,True"))
    assert log.runs[0].poses.t.tolist() == [0.0, 0.2]


def test_several_files_are_one_log_whose_runs_have_names_of_their_own(tmp_path: Path) -> None:
    header = f"run,{HEADER}"
    paths = [table(tmp_path, "r,0,1,0,0,0,0,1", header=header, name=name) for name in ("a.csv", "b.csv")]
    log = open_log(*paths)
    assert [run.name for run in log.runs] == ["a/r", "b/r"]
    assert len({source.sha256 for source in log.sources}) == 1
    assert [source.path for source in log.sources] == [str(path) for path in paths]


def test_a_gap_of_a_minute_is_no_fault_of_the_file(tmp_path: Path) -> None:
    times = [*np.arange(0, 5, 0.1), *np.arange(65, 70, 0.1)]
    log = open_log(table(tmp_path, *(f"{t:.1f},0.5,0,{0.5 * t:.3f},0,0,1" for t in times)))
    assert len(log.runs[0].poses) == 100
    assert log.left_out == ()


def test_a_negative_radius_is_refused() -> None:
    with pytest.raises(SettingsError, match="--wheel-radius must be a positive number"):
        LogOptions(wheel_radius=-0.1)


def direction_table(tmp_path: Path) -> Path:
    header = "t,cmd_v,cmd_dir,x,y,yaw,yaw_body,pose_new"
    rows = [f"{0.1 * k:.1f},0.2,1.570796327,0,{0.02 * k:.3f},1.5708,0,1" for k in range(30)]
    return table(tmp_path, *rows, header=header)


def test_a_vehicle_that_drives_sideways_takes_a_speed_along_a_direction(tmp_path: Path) -> None:
    log = open_log(direction_table(tmp_path), options=LogOptions(vehicle="robotino"))
    (run,) = log.runs
    assert run.commands is not None
    assert np.allclose(run.commands.v, 0.0, atol=1e-6)
    assert np.allclose(run.commands.vy, 0.2)
    assert not run.commands.omega.any()
    assert not run.poses.yaw.any()  # of the body, not of the travel
    assert log.sideways
    assert run.wheels is None
    assert any("no speeds of the wheels of robotino" in note for note in log.notes)


def test_other_vehicles_do_not_know_a_direction(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="cmd_omega"):
        open_log(direction_table(tmp_path), options=LogOptions(vehicle="husky"))
    assert not LogOptions(vehicle="husky").sideways
    assert not LogOptions().sideways
    assert LogOptions(vehicle="dingo-omni").sideways
