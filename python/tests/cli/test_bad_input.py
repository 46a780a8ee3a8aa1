# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with the input is said in one line with exit code 2, or left out and counted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Columns, Result, left_in, write_csv

Slipwise = Callable[..., Result]
BASIS = ("--basis", "edd-2")  # what is left out does not depend on it


def counts(slipwise: Slipwise, path: Path) -> dict[str, int]:
    """Calibrate from a damaged log that is still good for learning; return what was left out, by kind."""
    result = slipwise("calibrate", path, *BASIS, "--no-report", "--json", "-")
    assert result.code == 0, result
    assert result.err == ""
    found: dict[str, int] = {}
    for entry in result.json["left_out"]:
        assert entry["where"]
        found[entry["kind"]] = found.get(entry["kind"], 0) + entry["count"]
    return found


def refusal(slipwise: Slipwise, folder: Path, *arguments: object) -> str:
    """Return the one line of a command that fails with 2 and leaves nothing behind."""
    before = left_in(folder)
    result = slipwise(*arguments)
    assert result.code == 2, result
    assert result.out == ""
    assert left_in(folder) == before
    return result.line


def test_an_empty_file_is_refused(slipwise: Slipwise, folder: Path, subtests: pytest.Subtests) -> None:
    for name in ["drive.csv", "drive.csv.gz", "drive.parquet", "drive.mcap", "drive.bag"]:
        with subtests.test(name=name):
            (folder / name).touch()
            assert refusal(slipwise, folder, "calibrate", name).startswith(f"the file is empty ({name})")


def test_nothing_is_learned_across_a_gap_of_a_minute(
    slipwise: Slipwise, columns: Columns, folder: Path
) -> None:
    columns["t"][900:] += 60.0
    assert counts(slipwise, write_csv(folder / "gap.csv", columns)) == {"late-pose": 1}


def test_a_file_that_is_no_model_is_refused(slipwise: Slipwise, drive_csv: Path) -> None:
    """Others stand in models/test_yaml_file.py and models/test_model.py."""
    for content, expected in [
        ("a: &a [x, x]\nb: [*a, *a]\n", "aliases are not allowed"),
        ("colour: blue\n", "is it a slipwise model?"),
    ]:
        Path("model.yaml").write_text(content)
        line = refusal(slipwise, drive_csv.parent, "evaluate", drive_csv, "--model", "model.yaml")
        assert "model.yaml" in line
        assert expected in line


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("basis = ", "not a TOML file"),
        ("basis = 'edd-3'", "unknown slip basis 'edd-3'; known are edd-2"),
    ],
)
def test_wrong_settings_are_refused(slipwise: Slipwise, drive_csv: Path, content: str, expected: str) -> None:
    Path("settings.toml").write_text(content)
    line = refusal(slipwise, drive_csv.parent, "calibrate", drive_csv, "--settings", "settings.toml")
    assert expected in line


def test_wrong_use_is_said_in_one_line(
    slipwise: Slipwise, drive_csv: Path, subtests: pytest.Subtests
) -> None:
    for arguments, expected in [
        (["--bogus"], "No such option: --bogus"),
        (["frobnicate"], "No such command 'frobnicate'"),
        (["calibrate"], "Missing argument 'LOG...'"),
        (["calibrate", "drive.csv", "--inptu", "wheel"], "No such option: --inptu"),
        (
            ["calibrate", "drive.csv", "--input", "thrust"],
            "unknown input 'thrust' (--input): use command or wheel",
        ),
        (["calibrate", "drive.csv", "--wheel-separation", "wide"], "--wheel-separation"),
        (
            ["calibrate", "drive.csv", "--wheel-separation", "-1"],
            "wheel-separation must be a positive number of metres",
        ),
        (["evaluate", "drive.csv", "--horizons", "1,soon"], "'1,soon' is not a list of seconds (--horizons)"),
        (["evaluate", "drive.csv", "--horizons", "0"], "horizons must be positive seconds"),
        (["evaluate", "drive.csv", "--methods", "magic"], "unknown method 'magic'"),
        (["evaluate", "drive.csv", "--methods", "vendor"], "give --vendor-wheel-separation-multiplier"),
        (["evaluate", "drive.csv", "--methods", "none", "--report", "r.html"], "add auto to --methods"),
        (["evaluate", "drive.csv", "--horizons", "600"], "no two windows of any horizon"),
        (["convert", "drive.csv", "-o", "drive.doc"], "unknown kind of log file (drive.doc)"),
        (["simulate", "-o", "drive.csv", "--drive", "wild"], "unknown drive 'wild'"),
        (["simulate", "-o", "drive.csv", "--duration", "-5"], "duration is -5.0"),
        (["demo", "--duration", "nan"], "the demonstration lasts nan s"),
    ]:
        with subtests.test(arguments=arguments, expected=expected):
            assert expected in refusal(slipwise, drive_csv.parent, *arguments)


def test_the_process_itself_ends_with_one_line_and_2(process: Slipwise, folder: Path) -> None:
    assert refusal(process, folder, "calibrate", "no.csv") == "no such file (no.csv): check the path"


def test_control_characters_in_a_log_do_not_reach_the_terminal(
    slipwise: Slipwise, columns: Columns, folder: Path
) -> None:
    rows = np.column_stack([columns[name] for name in ("t", "cmd_v", "cmd_omega", "x", "y", "yaw")])
    rows[500, 0] = rows[499, 0]
    lines = [",".join(f"{value:.9g}" for value in row) + ",\x1b[2Jrun" for row in rows]
    Path("hostile.csv").write_text("\n".join(["t,cmd_v,cmd_omega,x,y,yaw,run", *lines]) + "\n")
    result = slipwise("inspect", "hostile.csv")
    assert result.code == 0
    assert "\x1b" not in result.out + result.err
