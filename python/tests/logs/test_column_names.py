# SPDX-License-Identifier: Apache-2.0
"""A table may name its columns as it likes."""

from pathlib import Path

import pytest

from slipwise.errors import LogError, SettingsError
from slipwise.logs import LogOptions, open_log
from slipwise.logs.column_names import parse_columns, renamed

ROWS = "0,1,0,0,0,0\n1,1,0,1,0,0\n"
COLUMNS = {"t": "time", "cmd_v": "vx", "cmd_omega": "wz"}


def test_columns_are_read_under_the_names_that_are_given(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,vx,wz,x,y,yaw\n" + ROWS)
    (run,) = open_log(tmp_path / "a.csv", options=LogOptions(columns=COLUMNS)).runs
    assert run.commands is not None
    assert run.commands.v.tolist() == [1.0, 1.0]
    assert run.poses.x.tolist() == [0.0, 1.0]


def test_names_can_be_exchanged_and_replaced_ones_are_kept() -> None:
    path = Path("a.csv")
    assert renamed(["x", "y"], {"x": "y", "y": "x"}, path) == ["y", "x"]
    assert renamed(["t", "time"], {"t": "time"}, path) == ["_t", "t"]


def test_missing_columns_name_the_option(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("time,vx,wz,x,y,yaw\n" + ROWS)
    with pytest.raises(
        LogError, match=r"missing columns: t; cmd_v.*found time, vx.*--columns t=time,cmd_v=vx"
    ):
        open_log(tmp_path / "a.csv")
    with pytest.raises(LogError, match=r"there is no column stamp \(for t=stamp\).*out of time, vx"):
        open_log(tmp_path / "a.csv", options=LogOptions(columns={"t": "stamp"}))
    with pytest.raises(SettingsError, match=r"speed is not a column of a tidy log .*cmd_v"):
        open_log(tmp_path / "a.csv", options=LogOptions(columns={"speed": "vx"}))


def test_the_text_of_the_option_is_pairs() -> None:
    assert parse_columns("t=time, cmd_v = vx") == {"t": "time", "cmd_v": "vx"}
    for text, message in (
        ("t", "not a pair"),
        ("t=", "not a pair"),
        ("", "not a pair"),
        ("t=a,t=b", "given twice"),
    ):
        with pytest.raises(SettingsError, match=message):
            parse_columns(text)
