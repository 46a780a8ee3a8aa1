# SPDX-License-Identifier: Apache-2.0
"""Files of poses are read as other programs write them, and what is wrong with them is counted or refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.pose_file import PoseFile, read_pose_file

TUM = "0.5 1 2 3 0 0 0.479425539 0.877582562\n0.6 1.1 2 3 0 0 0.479425539 0.877582562\n"


def read(
    path: Path, content: str, columns: dict[str, str] | None = None, tally: Tally | None = None
) -> PoseFile:
    path.write_text(content)
    return read_pose_file(path, columns or {}, tally or Tally())


def test_tum_and_tables_say_the_same(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for content in [
        TUM,
        "# timestamp tx ty tz qx qy qz qw\n" + TUM,
        TUM.replace(" ", ","),
        TUM.replace("0.5 1", "5.000000000000e-01   1.0"),
        "timestamp,tx,ty,tz,qx,qy,qz,qw\n" + TUM.replace(" ", ","),
        "t,x,y,yaw\n0.5,1,2,1\n0.6,1.1,2,1\n",
    ]:
        with subtests.test(content=content):
            stream = read(tmp_path / "a.txt", content).stream
            np.testing.assert_allclose(stream.t, [0.5, 0.6])
            np.testing.assert_allclose(stream.columns["x"], [1.0, 1.1])
            np.testing.assert_allclose(stream.columns["y"], [2.0, 2.0])
            np.testing.assert_allclose(stream.columns["yaw"], [1.0, 1.0], atol=1e-6)


def test_a_parquet_table_and_names_of_its_own_are_read(tmp_path: Path) -> None:
    table = pa.table({"secs": [0.5], "east": [1.0], "north": [2.0], "heading": [1.0], "std_xy": [0.01]})
    pa.parquet.write_table(table, tmp_path / "a.parquet")
    columns = {"t": "secs", "x": "east", "y": "north", "yaw": "heading", "cmd_v": "of the log"}
    found = read_pose_file(tmp_path / "a.parquet", columns, Tally())
    assert (found.format, found.stream.columns["std_xy"].tolist()) == ("parquet", [0.01])
    with pytest.raises(LogError, match=r"missing columns: t; x; y .*found secs, east.*--columns"):
        read_pose_file(tmp_path / "a.parquet", {}, Tally())


def test_nanoseconds_are_turned_into_seconds(tmp_path: Path) -> None:
    found = read(
        tmp_path / "a.txt",
        TUM.replace("0.5 1", "1700000000500000000 1").replace("0.6 1.1", "1700000000600000000 1.1"),
    )
    np.testing.assert_allclose(np.diff(found.stream.t), 0.1, atol=1e-6)
    assert "stamps of the poses are in nanoseconds" in found.notes


def test_broken_lines_and_bad_quaternions_are_counted_with_their_line(tmp_path: Path) -> None:
    tally = Tally()
    content = TUM + "0.7 1.2 2\n0.8 oops 2 3 0 0 0 1\n0.9 1 2 3 0 0 0 0\n"
    assert len(read(tmp_path / "a.txt", content, tally=tally).stream.t) == 2
    left_out = {entry.kind: (entry.count, entry.where) for entry in tally.result()}
    assert left_out == {"broken-row": (2, "a.txt, line 3"), "bad-quaternion": (1, "a.txt, line 5")}


def test_other_files_are_refused_with_what_would_do(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for content, message in [
        (
            "1 0 0 0 0 1 0 0 0 0 1 0\n",
            "poses of the KITTI format have no times.*put times.txt or a_times.txt.*_tum.txt",
        ),
        ("1 2 3\n", "3 numbers in a line are no pose .*: give TUM"),
        ("a,b\n1,2\n", "missing columns: t; x; y"),
        ("t,x,y,yaw\n", "holds no poses"),
        ("0 1 2 3 0 0 0 0\n", "holds no poses"),
        ("1 0 0 0 0 1 0 0 0 0 1\n", "11 numbers in a line are no pose"),
    ]:
        with subtests.test(content=content, message=message), pytest.raises(LogError, match=message):
            read(tmp_path / "a.txt", content)


def test_stamps_that_are_no_numbers_are_no_reason_to_stumble(tmp_path: Path) -> None:
    found = read(tmp_path / "a.txt", "nan 1 2 3 0 0 0 1\ninf 1 2 3 0 0 0 1\n")
    assert not np.isfinite(found.stream.t).any()


def test_bags_folders_and_missing_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"\x89MCAP0\r\n1234")
    with pytest.raises(LogError, match=r"a bag is not a file of poses .*--pose-topic"):
        read_pose_file(tmp_path / "a.mcap", {}, Tally())
    with pytest.raises(LogError, match="a folder is not a file of poses"):
        read_pose_file(tmp_path, {}, Tally())
    with pytest.raises(LogError, match=r"no such file .*--poses"):
        read_pose_file(tmp_path / "none.txt", {}, Tally())
    (tmp_path / "b.txt").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(LogError, match="not a file of poses"):
        read_pose_file(tmp_path / "b.txt", {}, Tally())
