# SPDX-License-Identifier: Apache-2.0
"""Tables of an IMU and of currents become runs with both."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_terrain import made_recordings, write_tables

from slipwise.errors import LogError
from slipwise.terrain import read_recordings

IMU = "time,wx,wy,wz,ax,ay,az\n"


def test_two_files_are_joined_by_run(tmp_path: Path) -> None:
    made = made_recordings(runs=1, seconds=3.0)
    found, notes = read_recordings(write_tables(tmp_path, made))
    assert [recording.run for recording in found] == ["grass_0", "gravel_0", "tiles_0"]
    assert notes == []
    for recording, original in zip(found, made, strict=True):
        assert recording.imu is not None
        assert recording.drive is not None
        assert original.imu is not None
        assert original.drive is not None
        np.testing.assert_allclose(recording.imu.values, original.imu.values, rtol=1e-4, atol=1e-6)
        np.testing.assert_allclose(recording.drive.t, original.drive.t, atol=1e-9)
        assert recording.label(0.0, 3.0) == original.labels[0]


def test_a_table_without_runs_is_one_run_of_the_files_name(tmp_path: Path) -> None:
    path = tmp_path / "monday.csv"
    path.write_text(IMU + "0.00,0,0,0,0,0,9.8\n0.01,0,0,0,0,0,9.8\n")
    (recording,), _ = read_recordings([path])
    assert (recording.run, recording.drive, recording.span) == ("monday", None, (0.0, 0.01))
    assert recording.label(0.0, 1.0) == ""


def test_two_surfaces_within_a_time_have_no_label(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    path.write_text(
        "time,curL,curR,velL,velR,terrain\n0,1,1,0,0,sand\n1,1,1,0,0,sand\n2,1,1,0,0,grass\n3,1,1,0,0,\n"
    )
    (recording,), _ = read_recordings([path])
    assert [recording.label(*span) for span in ((0, 2), (0, 3), (2, 4), (3, 4))] == ["sand", "", "grass", ""]


def test_what_is_left_out_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "imu.csv"
    rows = ["0.00,0,0,0,0,0,9", "0.02,0,0,0,0,0,9", "0.01,0,0,0,0,0,9", "0.03,nan,0,0,0,0,9", "0.04,1,1"]
    path.write_text(IMU + "\n".join([*rows, "0.05,0,0,0,0,0,9"]) + "\n")
    (recording,), notes = read_recordings([path])
    assert recording.imu is not None
    assert recording.imu.t.tolist() == [0.0, 0.02, 0.05]
    assert len(notes) == 3
    assert "left out: 1 rows whose time does not go on" in " ".join(notes)


def test_a_table_that_says_nothing_is_refused(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for text, message in [
        ("time,x,y\n0,1,2\n", "neither IMU nor motor currents"),
        ("wx,wy,wz,ax,ay,az\n0,0,0,0,0,0\n", "neither IMU nor motor currents"),
        (IMU + "0,0,0,0,0,0,9\n", "no run has a measurement"),
        (IMU + "0,0,0,zero,0,0,9\n", "not a tidy table"),
        ("", "the file is empty"),
    ]:
        with subtests.test(text=text, message=message):
            path = tmp_path / "table.csv"
            path.write_text(text)
            with pytest.raises(LogError, match=message):
                read_recordings([path])


def test_one_run_with_a_sensor_in_two_files_is_refused(tmp_path: Path) -> None:
    imu, _ = write_tables(tmp_path, made_recordings(runs=1, seconds=2.0))
    copy = tmp_path / "copy.csv"
    copy.write_bytes(imu.read_bytes())
    with pytest.raises(LogError, match="run grass_0 has columns of the imu in two files"):
        read_recordings([imu, copy])
