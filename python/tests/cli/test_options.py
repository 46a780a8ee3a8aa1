# SPDX-License-Identifier: Apache-2.0
"""Every command that reads a log takes the same options, on the command line or in a settings file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Columns, Result, write_csv

from slipwise.cli.older_names import with_new_names
from slipwise.cli.options import chosen_settings
from slipwise.log_fields import LOG_FIELDS

Slipwise = Callable[..., Result]


def own_names(folder: Path, columns: Columns) -> Path:
    """The log with other names of its columns."""
    names = {"t": "time", "cmd_v": "vx"}
    return write_csv(folder / "own.csv", {names.get(name, name): v for name, v in columns.items()})


def tum_of(folder: Path, columns: Columns, away: float) -> Path:
    half, zero = 0.5 * columns["yaw"], np.zeros(len(columns["t"]))
    rows = [columns["t"] - away, columns["x"], columns["y"], zero, zero, zero, np.sin(half), np.cos(half)]
    np.savetxt(folder / "poses.txt", np.column_stack(rows), fmt="%.9f")
    return folder / "poses.txt"


READERS = ("inspect", "calibrate", "evaluate", "compare", "live", "convert", "score")


def options_in(text: str) -> set[str]:
    return set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", text, re.MULTILINE))


def test_every_command_that_reads_a_log_takes_its_options_and_shows_them_apart(slipwise: Slipwise) -> None:
    reading = {about.option for about in LOG_FIELDS}
    for command in READERS:
        own, log = (options_in(slipwise(command, page).out) for page in ("--help", "--help-log"))
        assert not own & reading, command
        assert log >= reading - {"--vehicle"}, command
    assert "--vehicle" in options_in(slipwise("calibrate", "--help-log").out)


def test_few_options_stand_beside_those_of_reading(slipwise: Slipwise) -> None:
    for command, most in (("calibrate", 12), ("live", 16)):
        own = options_in(slipwise(command, "--help").out) - {"--help", "--help-log"}
        assert len(own) <= most, (command, own)


def test_options_are_read_under_their_older_names_with_a_note(capsys: pytest.CaptureFixture[str]) -> None:
    older = ["calibrate", "a.csv", "--estimator", "iekf", "--smooth", "--terrain=sand", "--memory", "m.yaml"]
    assert with_new_names(older) == [
        *("calibrate", "a.csv", "--set", "estimator=iekf", "--set", "smoothing.smooth=true"),
        *("--surface", "sand", "--memory", "m.yaml"),
    ]
    live = ["live", "--vehicle", "husky-1", "--memory", "m.yaml", "--for", "5", "--network"]
    assert with_new_names(live) == [
        *("live", "--name", "husky-1", "--memory", "--model", "m.yaml"),
        *("--set", "live.duration=5", "--set", "live.network=true"),
    ]
    notes = capsys.readouterr().err.splitlines()
    assert len(notes) == 7
    assert "note: live --vehicle is now --name" in notes
    assert with_new_names(["plan", "--no-picture", "--json", "-"]) == ["plan", "--json", "-"]
    assert "--no-picture is gone" in capsys.readouterr().err
    assert with_new_names(["inspect", "--most-fetched", "9", "a.csv"]) == ["inspect", "a.csv"]
    assert "--most-fetched is gone: 4096 MiB at most" in capsys.readouterr().err
    for driven in ("mecanum.yaml", "dart"):
        assert with_new_names(["live", "--vehicle", driven]) == ["live", "--vehicle", driven]
    now = ["calibrate", "a.csv", "--vehicle", "husky", "--set", "estimator=iekf"]
    assert with_new_names(now) == now


def test_a_setting_on_the_command_line_goes_before_the_file(slipwise: Slipwise, drive_csv: Path) -> None:
    Path("a.toml").write_text("[log]\nstart = 10.0\nend = 20.0\n")
    given = ("convert", drive_csv, "-o", "a.csv", "--settings", "a.toml")
    assert "only 10 s to 20 s" in slipwise(*given).out
    chosen = chosen_settings(Path("a.toml"), ["log.end=30", "basis=edd-2", "prior.slip_fraction=0.5"])
    assert (chosen.log.start, chosen.log.end, chosen.basis, chosen.prior.slip_fraction) == (
        10.0,
        30.0,
        "edd-2",
        0.5,
    )
    assert "sets no key" in slipwise("inspect", drive_csv, "--set", "huber").line
    assert "filter.hubber" in slipwise("inspect", drive_csv, "--set", "filter.hubber=3").line


def test_columns_and_a_span_are_taken_from_the_command_line(
    slipwise: Slipwise, folder: Path, columns: Columns
) -> None:
    own_names(folder, columns)
    given = ("--columns", "t=time,cmd_v=vx", "--start", "10", "--end", "20")
    result = slipwise("convert", "own.csv", "-o", "cut.csv", *given)
    assert result.code == 0, result.err
    assert "only 10 s to 20 s of 90.0 s are used" in result.out
    kept = np.genfromtxt(folder / "cut.csv", delimiter=",", names=True)
    assert (kept["t"][0], kept["t"][-1]) == (10.0, 20.0)


def test_a_settings_file_says_it_once_and_the_command_line_goes_before(
    slipwise: Slipwise, folder: Path, columns: Columns
) -> None:
    own_names(folder, columns)
    text = '[log]\nstart = 10.0\nend = 20.0\ncolumns = { t = "time", cmd_v = "vx" }\n'
    (folder / "log.toml").write_text(text)
    result = slipwise("convert", "own.csv", "-o", "cut.csv", "--settings", "log.toml", "--end", "30")
    assert result.code == 0, result.err
    assert "only 10 s to 30 s of 90.0 s are used" in result.out


def test_poses_beside_a_log_find_its_clock_on_the_command_line(
    slipwise: Slipwise, folder: Path, columns: Columns
) -> None:
    tum_of(folder, columns, away=1077.0)
    inputs = {name: v for name, v in columns.items() if name not in ("x", "y", "yaw")}
    write_csv(folder / "inputs.csv", inputs)
    given = ("--poses", "poses.txt", "--pose-clock-offset")
    line = slipwise("convert", "inputs.csv", "-o", "a.csv", "--poses", "poses.txt").line
    assert "no pose lies within the log" in line
    assert "--pose-clock-offset auto" in line
    found = slipwise("convert", "inputs.csv", "-o", "a.csv", *given, "auto")
    assert (found.code, "s are added to the stamps of poses.txt" in found.out) == (0, True)
    assert slipwise("convert", "inputs.csv", "-o", "a.csv", *given, "1077").code == 0
    kept = np.genfromtxt(folder / "a.csv", delimiter=",", names=True)
    np.testing.assert_allclose(kept["x"][np.isfinite(kept["x"])], columns["x"], atol=1e-6)


def test_the_file_of_poses_is_never_replaced(slipwise: Slipwise, folder: Path, drive_csv: Path) -> None:
    poses = folder / "poses.csv"
    poses.write_text("t,x,y,yaw\n0,0,0,0\n1,1,0,0\n")
    before = poses.read_text()
    assert slipwise("convert", drive_csv, "--poses", "poses.csv", "-o", "poses.csv").code == 2
    assert slipwise("inspect", drive_csv, "--poses", "poses.csv", "--json", "poses.csv").code == 2
    assert poses.read_text() == before


def test_a_wrong_option_is_one_line_that_names_it(slipwise: Slipwise, drive_csv: Path) -> None:
    def refused(*given: str) -> str:
        return slipwise("convert", drive_csv, "-o", "a.csv", *given).line

    assert refused("--pose-clock-offset", "soon").startswith(
        "--pose-clock-offset must be a number of seconds"
    )
    assert refused("--start", "9", "--end", "3").startswith("--end (3 s) is not after --start (9 s)")
    assert refused("--columns", "t").startswith("'t' is not a pair of names (--columns)")
    assert refused("--wheelbase", "-1").startswith("--wheelbase must be a positive number of metres")
