# SPDX-License-Identifier: Apache-2.0
"""Tests of tables as others write them: line ends, column types, texts and names that do not fit."""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from slipwise.errors import LogError
from slipwise.logs import open_log

HEADER = "run,t,cmd_v,cmd_omega,x,y,yaw"
ROWS = [f"one,{0.1 * i:.1f},1,0,{0.1 * i:.1f},0,0" for i in range(40)]
T = np.arange(40) * 0.1


def parquet(path: Path, **changed: Any) -> Path:
    zero = np.zeros(40)
    columns: dict[str, Any] = {"t": T, "cmd_v": zero + 1.0, "cmd_omega": zero, "x": T, "y": zero, "yaw": zero}
    pq.write_table(pa.table(columns | changed), path)
    return path


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_may_end_as_on_any_system(tmp_path: Path, end: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes((end.join([HEADER, *ROWS]) + end).encode())
    assert len(open_log(path).runs[0].poses) == 40


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (HEADER.replace("run,t,", "run,t\r").encode() + b"\n0\n", "missing columns"),
        (b'"t,x\n', "missing columns|not a text file"),
        (b"\xff\xfe\xfat,x\n1,2\n", "not a text file"),
    ],
)
def test_a_damaged_table_is_refused_in_one_line(tmp_path: Path, content: bytes, expected: str) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(LogError, match=expected) as caught:
        open_log(path)
    assert "\n" not in str(caught.value)


WRONG_COLUMNS: dict[str, tuple[dict[str, Any], str]] = {
    "frames as lists": ({"frame": pa.array([[1]] * 40)}, "not names in column frame"),
    "runs as records": ({"run": pa.array([{"a": 1}] * 40)}, "not names in column run"),
    "runs that are no text": (
        {"run": pa.array([b"\xff\xfe"] * 40, pa.binary()).cast(pa.string(), safe=False)},
        "not names in column run|not a readable Parquet file",
    ),
    "dates": ({"x": pa.array([dt.date(2026, 1, 1)] * 40)}, "not a number in column x"),
    "times": (
        {"t": pa.array([dt.datetime(2026, 1, 1, tzinfo=dt.UTC)] * 40)},
        "column t must hold seconds as numbers",
    ),
    "nanoseconds": ({"t": np.arange(40) * 100_000_000 + 1_700_000_000_000_000_003}, "look like nanoseconds"),
    "milliseconds": ({"t": np.arange(40) * 100 + 1_700_000_000_000}, "look like milliseconds"),
    "an overflow": ({"t": np.full(40, 2**63 - 1)}, "no time in any unit"),
}


def test_a_column_of_another_kind_is_named(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for kind, (changed, expected) in WRONG_COLUMNS.items():
        with subtests.test(kind=kind), pytest.raises(LogError, match=expected):
            open_log(parquet(tmp_path / "a.parquet", **changed))


def test_a_column_that_is_carried_along_but_cannot_be_read_is_noted(tmp_path: Path) -> None:
    bad = pa.array([b"\xff\xfe"] * 40).view(pa.string())
    log = open_log(parquet(tmp_path / "a.parquet", terrain_note=bad))
    assert len(log.runs[0].poses) == 40
    assert log.notes[-1] == "a.parquet: column 'terrain_note' cannot be read and is not carried along"


def test_a_column_that_is_there_twice_is_refused(tmp_path: Path) -> None:
    table = pa.Table.from_arrays([pa.array(T)] * 2, names=["t", "t"])
    pq.write_table(table, tmp_path / "a.parquet")
    with pytest.raises(LogError, match="column t is there twice"):
        open_log(tmp_path / "a.parquet")


def test_rows_with_bytes_that_are_no_text_are_read_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = [f"{row},\xe9t\xe9".encode("latin-1") for row in ROWS]
    path.write_bytes(
        b"\n".join([f"{HEADER},note".encode(), *rows[:20], b"one,2.0,1\xff", *rows[20:]]) + b"\n"
    )
    log = open_log(path)
    assert len(log.runs[0].poses) == 40
    found = {entry.kind: entry for entry in log.left_out}
    assert found["broken-row"].count == 1
    assert (found["bad-text"].count, found["bad-text"].where) == (81, "a.csv, line 2")
