# SPDX-License-Identifier: Apache-2.0
"""A log is learned once: a second time it is refused, or said where learning goes on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Result
from sample_surfaces import FIRM, LOOSE, floor_log

from slipwise.calibration.calibrate_sequence import calibrate_sequence
from slipwise.calibration.same_log import learned_from, refuse_same_log
from slipwise.errors import LogError
from slipwise.logs import open_log, save_log
from slipwise.logs.log import Run
from slipwise.logs.open_log import joined
from slipwise.models import load_model

Slipwise = Callable[..., Result]
WHEEL = ("--input", "wheel")


@pytest.fixture
def log(folder: Path) -> Path:
    path = folder / "base.csv"
    save_log(floor_log(FIRM, 1), path)
    return path


@pytest.fixture
def copy(log: Path) -> Path:
    path = log.with_name("copy.csv")
    path.write_bytes(log.read_bytes())
    return path


def test_a_log_given_twice_is_refused(slipwise: Slipwise, log: Path, copy: Path) -> None:
    calls = [("calibrate",), ("calibrate", "--memory"), ("evaluate",), ("evaluate", "--memory")]
    calls += [("convert", "-o", log.with_name("both.csv"))]
    for call in calls:
        same = slipwise(*call, log, log)
        assert same.code == 2
        assert same.line == f"a log is given twice ({log}): give it once"
        other = slipwise(*call, log, copy)
        assert other.code == 2
        assert other.line == f"the same log as {log} ({copy}): give it once"


def test_a_part_of_a_log_and_an_edited_copy_are_refused(slipwise: Slipwise, log: Path, folder: Path) -> None:
    lines = log.read_text().splitlines()
    half, noted = folder / "half.csv", folder / "noted.csv"
    half.write_text("\n".join(lines[: len(lines) // 2]) + "\n")
    noted.write_text("\n".join([f"{lines[0]},note", *(f"{line},x" for line in lines[1:])]) + "\n")
    for other in (half, noted):
        for call in (("calibrate",), ("evaluate", "--memory")):
            result = slipwise(*call, log, other)
            assert result.code == 2
            assert result.line == f"the same drive as in {log} ({other}): give it once"


def test_parts_of_one_file_are_other_drives(log: Path) -> None:
    parts = [open_log(log, end=30.0), open_log(log, start=30.0)]
    refuse_same_log(joined(parts))
    _, sequence = calibrate_sequence(parts, input="wheel")
    assert len(sequence.logs) == 2


def test_two_runs_of_one_file_are_other_drives(folder: Path) -> None:
    runs = [replace(floor_log(slip, 1).runs[0], name=name) for name, slip in (("a", FIRM), ("b", LOOSE))]
    path = folder / "runs.csv"
    save_log(replace(floor_log(FIRM, 1), runs=tuple(runs)), path)
    refuse_same_log(open_log(path))


@pytest.mark.parametrize("on", [False, True], ids=["same stamps", "stamps run on"])
def test_a_log_that_holds_its_drive_twice_is_refused(
    slipwise: Slipwise, log: Path, folder: Path, on: bool
) -> None:
    head, *rows = log.read_text().splitlines()
    column, again = head.replace('"', "").split(",").index("t"), [row.split(",") for row in rows]
    last = float(again[-1][column])
    for row in again:
        row[column] = str(float(row[column]) + on * (last + 0.05))
    path = folder / "twice.csv"
    path.write_text("\n".join((head, *rows, *map(",".join, again))) + "\n")
    first = open_log(log).runs[0]
    of = "" if on else f" of run {open_log(path).runs[0].name}"
    since = last + 0.05 if on else 0.0
    words = f"from {since:.1f} s on the poses are those from {first.poses.t[0]:.1f} s{of} again ({path}, run "
    for call in (("calibrate",), ("evaluate",), ("calibrate", "--memory"), ("convert", "-o", "out.csv")):
        result = slipwise(*call, path)
        assert result.code == 2
        assert result.line.startswith(f"a drive is there twice: {words}")
        assert result.line.endswith("): keep one of the two")


def test_a_drive_that_comes_again_in_a_second_run_of_one_file_is_refused() -> None:
    log = floor_log(FIRM, 1)
    run = log.runs[0]
    again = Run("b", None, None, replace(run.poses, t=run.poses.t + 1000.0), files=("a.csv",))
    with pytest.raises(LogError, match=r"from 0\.0 s on the poses are those from 0\.0 s of run a again"):
        refuse_same_log(replace(log, runs=(replace(run, name="a", files=("a.csv",)), again)))


def test_a_robot_that_stands_or_passes_the_same_places_otherwise_drives_nothing_again() -> None:
    log = floor_log(FIRM, 1)
    poses = log.runs[0].poses
    rows = np.arange(len(poses))
    stands, flickers, there_and_back = rows * 0, rows % 2, np.minimum(rows, rows[::-1])
    for places in (stands, flickers, there_and_back):
        other = replace(poses, x=poses.x[places], y=poses.y[places], yaw=poses.yaw[places])
        refuse_same_log(replace(log, runs=(replace(log.runs[0], files=("a.csv",), poses=other),)))


def test_going_on_with_a_log_that_was_learned_is_a_reservation(
    slipwise: Slipwise, folder: Path, log: Path, copy: Path
) -> None:
    first, second = folder / "mem.yaml", folder / "on.yaml"
    learn = ("calibrate", "--memory", *WHEEL, "--no-report")
    assert slipwise(*learn, log, "-o", first).code == 0
    assert load_model(first).verdict.reservations == []
    on = slipwise(*learn, first, copy, "-o", second)
    assert f"The model to begin with has learned {copy} already" in " ".join(on.out.split())
    assert "GOOD, WITH RESERVATIONS." in on.out
    verdict = load_model(second).verdict
    assert any("counts twice" in each for each in verdict.reservations)
    assert learned_from(open_log(copy), load_model(first)) == (str(copy),)


def test_a_merge_of_models_of_one_log_says_so(slipwise: Slipwise, folder: Path, log: Path) -> None:
    first, other, both = folder / "mem.yaml", folder / "other.yaml", folder / "both.yaml"
    learn = ("calibrate", "--memory", *WHEEL, "--no-report")
    assert slipwise(*learn, log, "-o", first).code == 0
    twice = slipwise("surfaces", "merge", first, first, "-o", both)
    assert twice.line == f"a model file is given twice ({first}): give each once"
    assert slipwise("surfaces", "rename", first, "surface 1", "hall", "-o", other).code == 0
    merged = slipwise("surfaces", "merge", first, other, "-o", both)
    assert merged.code == 0
    assert f"Both models have learned {log}, which counts twice" in " ".join(merged.out.split())
    assert "which counts twice" in load_model(both).verdict.reservations[-1]
    asked = slipwise("surfaces", "merge", first, other, "-o", both, "--json", "-").json
    assert asked["logs_of_both"] == [str(log)]
