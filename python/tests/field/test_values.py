# SPDX-License-Identifier: Apache-2.0
"""Values and formats that are not what they seem, in logs as they come from the field."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli.conftest import Result
from field.conftest import FieldLog
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.errors import LogError
from slipwise.logs import Log, Run
from slipwise.logs.findings.checks import findings_of
from slipwise.logs.log import LeftOut, empty_poses
from slipwise.logs.quality import checked

Slipwise = Callable[..., Result]


def learned(slipwise: Slipwise, *arguments: object) -> dict[str, Any]:
    """Learn a log that is good; return the document."""
    result = slipwise("calibrate", *arguments, "--no-report", "--json", "-")
    assert result.code == 0, result
    return result.json


def assert_true(document: dict[str, Any], yaw: float = 0.70) -> None:
    """The robot does 95 % of the speed and 70 % of the yaw rate of its wheels."""
    value = {p["name"]: p["value"] for p in document["parameters"]}
    assert value["lon.V"] == pytest.approx(-0.05, abs=0.015)
    assert value["ang.w"] == pytest.approx(yaw - 1.0, abs=0.015)


# A table of numbers without names, and files of poses


def test_a_table_of_numbers_without_names_says_so_and_is_read_by_number(
    slipwise: Slipwise, field_log: FieldLog
) -> None:
    log, poses = field_log("odometry.dat"), field_log("truth_tum.txt")
    nameless = slipwise("calibrate", log, "--poses", poses)
    assert nameless.code == 2
    assert "a table of 3 columns of numbers without names" in nameless.line
    assert "--columns t=0,odo_v=1,odo_omega=2" in nameless.line
    assert "forward velocity [m/s]" in nameless.line  # what the comment above says
    named = ("--columns", "t=0,odo_v=1,odo_omega=2")
    assert_true(learned(slipwise, log, "--poses", poses, *named))


def rows_of(path: Path) -> list[list[str]]:
    return [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]


def test_cells_may_be_separated_otherwise_and_names_stand_in_a_comment(
    slipwise: Slipwise, field_log: FieldLog, folder: Path, subtests: pytest.Subtests
) -> None:
    for head, separator in [
        ("# t,odo_v,odo_omega\n", ","),  # as numpy.savetxt writes it
        ("t\todo_v\todo_omega\n", "\t"),
        ("t;odo_v;odo_omega\n", " ; "),
        ("\n# of the morning\n\nt odo_v odo_omega\n# not the names\n", "   "),
        ("# t odo_v odo_omega\n\n", " "),
    ]:
        with subtests.test(head=head, separator=separator):
            rows = [separator.join(row) for row in rows_of(field_log("odometry.dat"))]
            rows.insert(100, "# a remark between rows")
            (folder / "drive.txt").write_text(head + "\n".join(rows) + "\n")
            result = slipwise(
                "convert", "drive.txt", "--poses", field_log("truth_tum.txt"), "-o", "drive.csv"
            )
            assert result.code == 0, result
            assert len((folder / "drive.csv").read_text().splitlines()) == len(
                rows
            )  # a header, and no remark


def test_columns_by_number_are_there_once(slipwise: Slipwise, field_log: FieldLog) -> None:
    given = ("calibrate", field_log("odometry.dat"), "--poses", field_log("truth_tum.txt"), "--columns")
    beyond = slipwise(*given, "t=0,odo_v=1,odo_omega=3")
    assert (beyond.code, "there is no column 3" in beyond.line, "from 0 to 2" in beyond.line) == (
        2,
        True,
        True,
    )
    twice = slipwise(*given, "t=0,odo_v=1,odo_omega=1")
    assert (twice.code, "names one column twice" in twice.line) == (2, True)


def kitti_of(rows: list[list[str]]) -> str:
    """Poses of the KITTI format without turns."""
    return "".join(f"1 0 0 {x} 0 1 0 {y} 0 0 1 0\n" for _, x, y, *_ in rows)


def test_a_file_of_poses_is_no_log(slipwise: Slipwise, field_log: FieldLog, folder: Path) -> None:
    tum = field_log("truth_tum.txt")
    (folder / "kitti.txt").write_text(kitti_of(rows_of(tum)))
    (folder / "plain.txt").write_text("".join(" ".join(row) + "\n" for row in rows_of(tum)))
    (folder / "track.nmea").write_text("$GPGGA,120000.00,4800.0,N,01100.0,E,4,12,1.0,500,M,46,M,,*5B\n")
    (folder / "track.gpx").write_text('<?xml version="1.0"?>\n<gpx version="1.1"></gpx>\n')
    rows = [",".join(row) for row in rows_of(tum)]
    (folder / "evo.csv").write_text("\n".join(("timestamp,tx,ty,tz,qx,qy,qz,qw", *rows)) + "\n")
    called = {
        tum: "a TUM pose file",
        "plain.txt": "a TUM pose file",
        "kitti.txt": "a KITTI pose file",
        "track.nmea": "an NMEA file",
        "track.gpx": "a GPX file",
    }
    assert "this is a table of poses" in slipwise("calibrate", "evo.csv").line
    for path, name in called.items():
        for verb in ("calibrate", "inspect"):
            result = slipwise(verb, path)
            assert result.code == 2
            assert f"this is {name}" in result.line
            assert f"LOG --poses {Path(path).name}" in result.line


def test_eight_numbers_without_a_rotation_are_no_poses(slipwise: Slipwise, folder: Path) -> None:
    rows = np.random.default_rng(1).normal(size=(50, 8))
    np.savetxt(folder / "numbers.txt", rows)
    assert "a table of 8 columns of numbers without names" in slipwise("calibrate", "numbers.txt").line


# Spikes of wheels


def test_spikes_of_a_yaw_that_wrapped_go_by_what_the_stream_holds(
    slipwise: Slipwise, field_log: FieldLog
) -> None:
    document = learned(slipwise, field_log("yaw_wrap_spike_3hz.mcap"), "--input", "wheel")
    assert {entry["kind"]: entry["count"] for entry in document["left_out"]}["absurd-speed"] == 4
    assert_true(document)
    assert document["held_out"]["heading"] < 0.05  # rad after 5 s; with the spikes 0.28


# A sensor away from the centre of turning


def test_an_antenna_away_from_the_centre_of_turning_is_named_with_its_place(
    slipwise: Slipwise, field_log: FieldLog, folder: Path
) -> None:
    log = (field_log("antenna_with_imu.mcap"), "--input", "wheel")
    document = learned(slipwise, *log)
    (said,) = (sentence for sentence in document["summary"] if "looks like a pose sensor" in sentence)
    assert "add --set sensor_extrinsics.x=0.45 --set sensor_extrinsics.y=0.10" in said
    assert said in slipwise("show", document["files"]["model"]).out
    (folder / "robot.toml").write_text("[sensor_extrinsics]\nx = 0.45\ny = 0.10\n")
    known = learned(slipwise, *log, "--settings", "robot.toml")
    assert not any("looks like" in sentence for sentence in known["summary"])
    assert_true(known)


# Headings that are a course over ground


def over_ground(log: Log) -> Log:
    """Turn the heading about where the robot reverses, as a receiver's course over ground."""

    def change(run: Run) -> Run:
        assert run.wheels is not None
        reverse = np.interp(run.poses.t, run.wheels.t, run.wheels.v) < 0.0
        yaw = np.where(reverse, run.poses.yaw + np.pi, run.poses.yaw)
        return replace(run, poses=replace(run.poses, yaw=np.arctan2(np.sin(yaw), np.cos(yaw))))

    return replace(log, runs=tuple(map(change, log.runs)))


def sound_log(speeds: tuple[float, float], seconds: float = 90.0) -> Log:
    basis = _core.named_basis("edd-2")
    return simulated_log(
        Drive(seconds=seconds, basis=basis, alpha=(-0.05, -0.3), speeds=speeds, hold=(60, 120))
    )


def test_headings_that_turn_about_in_reverse_leave_positions(slipwise: Slipwise, field_log: FieldLog) -> None:
    for source in ("command", "wheel"):
        log = (field_log("cog_heading_flip.mcap"), "--input", source)
        document = learned(slipwise, *log)
        assert any(
            "it is a course over ground; only positions are used" in note for note in document["notes"]
        )
        assert any(sentence.startswith("Only positions") for sentence in document["verdict"]["reservations"])
        speed, turns = (value_of(document, name) for name in ("lon.V", "ang.w"))
        assert abs(speed[0] + 0.05) < max(2.0 * speed[1], 0.02)
        assert abs(turns[0] + 0.30) < max(2.0 * turns[1], 0.02)


def value_of(document: dict[str, Any], name: str) -> tuple[float, float]:
    (found,) = (p for p in document["parameters"] if p["name"] == name)
    return found["value"], found["std"]


@pytest.mark.parametrize("speeds", [(-0.6, 0.6), (-0.15, 0.8), (-1.0, 0.3)])
def test_reverse_may_be_slow_or_seldom(speeds: tuple[float, float]) -> None:
    sound = sound_log(speeds)
    assert checked(sound).notes == ()
    (note,) = checked(over_ground(sound)).notes
    assert "only positions are used" in note
    assert not checked(over_ground(sound_log((0.1, 0.8)))).notes  # nothing shows it


def test_a_course_over_ground_is_a_contradiction_where_headings_are_learned_from() -> None:
    for source in ("command", "wheel"):
        every = findings_of(over_ground(sound_log((-0.4, 0.8))), source)
        (found,) = (each for each in every if each.spoils)
        assert (found.kind, found.spoils) == ("course-heading", True)
        assert "[live] positions = true" in found.advice[0]
        assert not any(each.spoils for each in findings_of(sound_log((-0.4, 0.8)), source))


def test_a_drive_that_follows_late_is_no_course_over_ground() -> None:
    late = Drive(seconds=120.0, lag=1.5, delay=0.4, speeds=(-0.3, 1.2))
    for seed in range(5):
        assert not checked(simulated_log(replace(late, seed=seed))).notes
        assert not findings_of(simulated_log(replace(late, seed=seed)), "command")


# Speeds in other units


def test_rates_in_another_unit_are_named_with_their_factor(subtests: pytest.Subtests) -> None:
    for factors, expected in [
        (
            (300.0, 300.0),
            ("0.0031 times as far", "rad/min of wheels of 0.19 m", "--wheel-scale F,F", "about 0.0031"),
        ),
        ((1000.0, 1000.0), ("in mm/s", "--wheel-scale F,F")),
        ((1.0, 9.549), ("it is not in rad/s", "in rev/min (times 0.1047)", "--wheel-scale 1,0.1047")),
        ((1.0, 57.296), ("looks like degrees per second", "--wheel-scale 1,0.01745", "1,0.01667")),
        ((1.0, 1000.0), ("it is not in rad/s", "in mrad/s (times 0.001)")),
    ]:
        with subtests.test(factors=factors, expected=expected):
            with pytest.raises(LogError) as caught:
                checked(in_other_units(sound_log((-0.5, 0.8)), factors))
            for words in expected:
                assert words in str(caught.value)
            assert ("degrees" in str(caught.value)) == (factors[1] == 57.296)


def in_other_units(log: Log, factors: tuple[float, float]) -> Log:
    def change(run: Run) -> Run:
        assert run.wheels is not None
        v, omega = run.wheels.v * factors[0], run.wheels.omega * factors[1]
        return replace(run, commands=None, wheels=replace(run.wheels, v=v, omega=omega))

    return replace(log, runs=tuple(map(change, log.runs)))


def test_wheels_in_radians_per_minute_are_cured_by_the_option(
    slipwise: Slipwise, field_log: FieldLog
) -> None:
    log = field_log("wheels_rad_per_min.csv")
    refused = slipwise("calibrate", log)
    assert refused.code == 2
    assert "degrees" not in refused.line.partition(":")[0]
    assert "rad/min of wheels of 0.19 m" in refused.line
    assert_true(learned(slipwise, log, "--wheel-scale", f"{0.2 / 60.0},{0.2 / 60.0}"))


# Poses that are there and cannot be used


def test_poses_that_are_all_left_out_are_said_with_the_reason() -> None:
    (run,) = sound_log((-0.4, 0.8), 20.0).runs
    lost = LeftOut("poses with a number missing or impossible", 400, "drive.mcap", "incomplete")
    log = Log((replace(run, poses=empty_poses()),), left_out=(lost,))
    with pytest.raises(LogError, match="no pose of the log can be used: 400 x poses with a number missing"):
        calibrate(log)


def test_poses_of_a_frame_each_are_said() -> None:
    (run,) = sound_log((-0.4, 0.8), 20.0).runs
    apart = replace(run.poses, frame=np.arange(len(run.poses), dtype=np.int64))
    with pytest.raises(LogError, match=r"400 poses have 400 frames, .*: give all the same"):
        calibrate(Log((replace(run, poses=apart),)))
