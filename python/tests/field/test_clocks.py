# SPDX-License-Identifier: Apache-2.0
"""Clocks in the field: headers by another clock than the recorder's, at another rate, or set back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from sample_bags import EPOCH, SECOND, Bag
from sample_field import (
    field_drive,
    field_path,
    learned,
    noisy,
    recorder,
    share_errors,
    write_commands,
    write_poses,
    write_wheels,
)

from slipwise.logs import open_log
from slipwise.logs.clock_steps import Arrivals, clock_steps, steps_back
from slipwise.logs.log import Floats


def offsets_of_commands(path: Path) -> Floats:
    """Return how long after poses of the same moment commands are dated, run by run, at begin and end [s]."""
    runs = open_log(path).runs
    both = [(run.commands.t, run.poses.t) for run in runs if run.commands is not None]
    return np.array([(c[0] - p[0], c[-1] - p[-1]) for c, p in both])


def ahead(seconds: float, rate: float = 1.0, begin: float = EPOCH / SECOND) -> Callable[[float], int]:
    """Return a clock that is so much ahead of the recorder's, or begins elsewhere and runs at a rate."""
    return lambda t: round((begin + seconds) * SECOND) + round(rate * t * SECOND)


@pytest.mark.parametrize("seconds", [1.7, -1.7, 0.4, 7200.0])
@pytest.mark.parametrize("poses_alone", [False, True], ids=["one clock", "poses alone"])
def test_commands_without_headers_are_dated_on_the_clock_of_the_headers(
    tmp_path: Path, seconds: float, poses_alone: bool
) -> None:
    drive, bag = field_drive(), Bag()
    write_commands(bag, drive)
    write_poses(bag, drive, stamped=ahead(seconds))
    write_wheels(bag, drive, stamped=recorder if poses_alone else ahead(seconds))
    said = "\n".join(open_log(path := bag.write(tmp_path / "a.mcap")).notes)
    side = "ahead of" if seconds > 0.0 else "behind"
    apart = f"{abs(seconds):.2f} s {side} the bag's"
    assert f"{apart}: /cmd_vel, without a header, gets their clock" in said
    assert ("the clock of /odom is not that of the poses" in said) == poses_alone
    assert np.abs(offsets_of_commands(path)).max() < 0.08


@pytest.mark.parametrize("rate", [0.5, 0.8, 1.3])
def test_commands_are_dated_in_simulated_time(tmp_path: Path, rate: float) -> None:
    drive, bag = field_drive(), Bag()
    simulated = {"received": ahead(0.0, 1.0 / rate), "stamped": ahead(0.0, begin=12.0)}
    write_commands(bag, drive, received=simulated["received"])
    write_poses(bag, drive, **simulated)
    write_wheels(bag, drive, **simulated)
    said = "\n".join(open_log(path := bag.write(tmp_path / "a.mcap")).notes)
    assert f"header stamps run at {rate:g} of the bag's clock" in said
    assert np.abs(offsets_of_commands(path)).max() < 0.08


def test_a_simulation_that_slows_down_is_followed(tmp_path: Path) -> None:
    drive, bag = field_drive(), Bag()

    def slowing(t: float) -> int:
        return recorder(t + 0.3 * max(t - 20.0, 0.0) + 0.5 * max(t - 40.0, 0.0))

    write_commands(bag, drive, received=slowing)
    write_poses(bag, drive, received=slowing, stamped=ahead(0.0, begin=12.0))
    write_wheels(bag, drive, received=slowing, stamped=ahead(0.0, begin=12.0))
    said = "\n".join(open_log(path := bag.write(tmp_path / "a.mcap")).notes)
    assert "of the bag's clock" in said
    assert np.abs(offsets_of_commands(path)).max() < 0.08


def late_table(tmp_path: Path, seconds: float) -> Path:
    drive = field_drive(120.0)
    rows, poses = [], noisy(drive)
    for k in drive.every(0.05):
        v, omega = drive.command[k]
        rows.append((float(drive.t[k]), f"{v:.4f},{omega:.4f},,,"))
    for k in drive.every(0.1):
        x, y, yaw = poses[k]
        rows.append((float(drive.t[k]) + seconds + 0.001, f",,{x:.4f},{y:.4f},{yaw:.4f}"))
    lines = [f"{t:.4f},{rest}" for t, rest in sorted(rows)]
    (tmp_path / "late.csv").write_text("\n".join(["t,cmd_v,cmd_omega,x,y,yaw", *lines]) + "\n")
    return tmp_path / "late.csv"


@pytest.mark.slow
def test_poses_that_answer_later_than_any_drive_are_not_good_before_their_clock_is_told(
    tmp_path: Path,
) -> None:
    path = late_table(tmp_path, 1.7)
    result, _ = learned(path)
    assert not result.verdict.good
    assert "later than any drive: their clocks differ" in result.verdict.sentence
    assert any("--pose-clock-offset auto" in text for text in result.verdict.advice)
    result, said = learned(path, pose_clock_offset="auto")
    assert "are added to the stamps of its poses" in said
    assert result.verdict.good
    assert np.abs(share_errors(result.model)).max() < 3.0
    result, said = learned(path, pose_clock_offset=-1.7)
    assert "-1.7 s are added to the stamps of its poses" in said
    assert result.verdict.good


def test_the_simulated_time_that_was_sent_in() -> None:
    result, said = learned(field_path("sim_clock_mixed.mcap"))
    assert "header stamps run at 0.8 of the bag's clock: /cmd_vel, without a header" in said
    assert np.abs(share_errors(result.model)).max() < 3.0


def test_the_clock_that_was_set_back_begins_a_run() -> None:
    result, said = learned(field_path("header_jumps_receipt_fine.mcap"), "wheel")
    assert "the clock was set back by 9.9 s: a new run begins" in said
    assert "goes backward" not in said
    assert np.abs(share_errors(result.model)).max() < 3.0


@pytest.mark.parametrize("seconds", [3.0, 25.0, 3600.0])
def test_a_clock_that_is_set_back_loses_nothing(tmp_path: Path, seconds: float) -> None:
    drive, bag = field_drive(), Bag()

    def jumping(t: float) -> int:
        return recorder(t - (seconds if t > 30.0 else 0.0))

    write_commands(bag, drive)
    write_poses(bag, drive, stamped=jumping)
    write_wheels(bag, drive, stamped=jumping)
    path = bag.write(tmp_path / "a.mcap")
    log = open_log(path)
    assert [len(run.poses) for run in log.runs] == [301, 299]
    assert not log.left_out
    assert any(f"the clock was set back by {seconds:.0f}"[:-1] in note for note in log.notes)
    assert np.abs(offsets_of_commands(path)).max() < 0.11


def test_steps_of_a_clock_are_told_from_faulty_stamps() -> None:
    t = 0.1 * np.arange(100)
    lone, reversed_t, missing = t.copy(), t[::-1].copy(), t.copy()
    lone[50] = 500.0
    missing[50:] -= 3.0
    missing[40:50] = np.nan
    assert [len(steps_back(each)) for each in (t, lone, reversed_t, missing)] == [0, 0, 0, 1]
    (step,) = clock_steps([Arrivals(t, missing)])
    assert f"{step.seconds:.1f}" == "1.9"


def test_a_table_whose_clock_is_set_back_is_two_runs(tmp_path: Path) -> None:
    drive = field_drive()
    poses = noisy(drive)
    rows = ["t,odo_v,odo_omega,x,y,yaw"]
    for k in drive.every(0.1):
        t = float(drive.t[k]) - (10.0 if drive.t[k] > 30.0 else 0.0)
        rows.append(",".join(f"{value:.4f}" for value in (t, *drive.wheels[k], *poses[k])))
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    log = open_log(tmp_path / "a.csv")
    assert [len(run.poses) for run in log.runs] == [301, 299]
    assert "the clock was set back by 9.9 s: a new run begins (a)" in log.notes
    assert not log.left_out
