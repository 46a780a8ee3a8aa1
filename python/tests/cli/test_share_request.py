# SPDX-License-Identifier: Apache-2.0
"""`slipwise convert --anonymise` writes a data set that `inspect --strict` takes; idle options are errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result, left_in

from slipwise.logs import open_log

Slipwise = Callable[..., Result]
STATED = ("--licence", "CC-BY-4.0", "--robot", 'a robot: 50 % "x"', "--sensors", "mocap")
SET = {"s.parquet", "s.schema.json", "s.card.yaml", "s.windows.csv"}


def test_a_shared_log_keeps_to_the_format(slipwise: Slipwise, drive_csv: Path, folder: Path) -> None:
    result = slipwise("convert", drive_csv, "-o", "s.parquet", "--anonymise", *STATED)
    assert (result.code, result.err) == (0, "")
    assert left_in(folder) == {"drive.csv"} | SET
    strict = slipwise("inspect", "s.parquet", "--strict")
    assert (strict.code, strict.out) == (0, "s.parquet: keeps to the format of shared logs\n")
    (run,) = open_log("s.parquet").runs
    assert run.name.startswith("run-")
    assert (run.poses.x[0], run.poses.y[0], run.poses.yaw[0], run.span[0]) == (0.0, 0.0, 0.0, 0.0)
    assert slipwise("score", "s.windows.csv", "s.parquet").code == 0


def test_what_is_not_stated_is_found(slipwise: Slipwise, drive_csv: Path) -> None:
    assert slipwise("convert", drive_csv, "-o", "s.parquet", "--card").code == 0
    strict = slipwise("inspect", "s.parquet", "--strict", "--json", "-")
    assert strict.code == 1
    assert [each["what"] for each in strict.json["departures"]] == [
        f"the {name} is not stated" for name in ("licence", "vehicle", "sensors")
    ]
    assert "3 departures" in slipwise("inspect", "s.parquet", "--strict").out


def test_options_that_cannot_be_are_one_line(
    slipwise: Slipwise, drive_csv: Path, folder: Path, subtests: pytest.Subtests
) -> None:
    for options, message in [
        (("-o", "s.csv", "--card"), "a data set to share is Parquet"),
        (("-o", "s.parquet", "--licence", "MIT"), "no card is written"),
        (("-o", "s.parquet", "--keep", "x"), "no columns are removed"),
        (("-o", "s.parquet", "--card", "--robot", " "), "no text given"),
        (("-o", "s.parquet", "--anonymise", "--keep", "gyro"), "no column gyro to keep"),
    ]:
        with subtests.test(options=options, message=message):
            result = slipwise("convert", drive_csv, *options)
            assert result.code == 2
            assert result.line.startswith(message)
            assert left_in(folder) == {"drive.csv"}


def test_a_file_beside_that_is_the_input_is_never_replaced(slipwise: Slipwise, drive_csv: Path) -> None:
    source = drive_csv.rename(drive_csv.with_name("s.windows.csv"))
    before = source.read_bytes()
    result = slipwise("convert", source, "-o", "s.parquet", "--card")
    assert result.line.startswith("this would replace what is read")
    assert source.read_bytes() == before
