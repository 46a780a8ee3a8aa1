# SPDX-License-Identifier: Apache-2.0
"""Values and formats that are not what they seem, in logs as they come from the field."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli.conftest import Result
from field.conftest import FieldLog

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


@pytest.mark.parametrize(
    ("head", "separator"),
    [
        ("# t,odo_v,odo_omega\n", ","),  # as numpy.savetxt writes it
        ("t\todo_v\todo_omega\n", "\t"),
        ("t;odo_v;odo_omega\n", " ; "),
        ("\n# of the morning\n\nt odo_v odo_omega\n# not the names\n", "   "),
    ],
)
def test_cells_may_be_separated_otherwise_and_names_stand_in_a_comment(
    slipwise: Slipwise, field_log: FieldLog, folder: Path, head: str, separator: str
) -> None:
    rows = [separator.join(row) for row in rows_of(field_log("odometry.dat"))]
    rows.insert(100, "# a remark between rows")
    (folder / "drive.txt").write_text(head + "\n".join(rows) + "\n")
    result = slipwise("convert", "drive.txt", "--poses", field_log("truth_tum.txt"), "-o", "drive.csv")
    assert result.code == 0, result
    assert len((folder / "drive.csv").read_text().splitlines()) == len(rows)  # a header, and no remark


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
    called = {
        tum: "a TUM pose file",
        "plain.txt": "a TUM pose file",
        "kitti.txt": "a KITTI pose file",
        "track.nmea": "an NMEA file",
        "track.gpx": "a GPX file",
    }
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
    assert "[sensor_extrinsics] x = 0.45, y = 0.10 in the settings" in said
    assert said in slipwise("show", document["files"]["model"]).out
    (folder / "robot.toml").write_text("[sensor_extrinsics]\nx = 0.45\ny = 0.10\n")
    known = learned(slipwise, *log, "--settings", "robot.toml")
    assert not any("looks like" in sentence for sentence in known["summary"])
    assert_true(known)
