# SPDX-License-Identifier: Apache-2.0
"""Logs that are learned together, one of which is of another robot, floor or unit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, scaled, sound_log, with_runs

from slipwise.calibration import calibrate
from slipwise.calibration.shares import PoseSensor
from slipwise.calibration.unlike_logs import KIND, unlike_logs
from slipwise.logs import Inputs, Log, Run
from slipwise.logs.findings.finding import Finding
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.motion_windows import evidence_of

DRIVES = [sound_log(replace(SKID_STEERED, seconds=90.0, seed=seed)) for seed in (1, 2, 3)]


def together(change: Callable[[Log], Log]) -> Log:
    """Three drives, the last of which is changed, as of three files."""
    logs = (*DRIVES[:2], change(DRIVES[2]))
    runs = [replace(log.runs[0], name=f"d{k}", files=(f"bags/d{k}.csv",)) for k, log in enumerate(logs)]
    return replace(DRIVES[0], runs=tuple(runs))


def with_commands(change: Callable[[Inputs], Inputs]) -> Callable[[Log], Log]:
    def change_run(run: Run) -> Run:
        assert run.commands is not None
        return replace(run, commands=change(run.commands))

    return lambda log: with_runs(log, change_run)


def found_in(log: Log, input_name: str = "command") -> tuple[Finding, ...]:
    rows = evidence_of(log.runs, UNKNOWN_AFTER).windows
    return unlike_logs(rows, log.runs, input_name, PoseSensor())


def test_drives_of_one_robot_are_alike() -> None:
    for input_name in ("command", "wheel"):
        assert found_in(together(lambda log: log), input_name) == ()


def test_runs_of_one_file_are_not_compared() -> None:
    log = together(lambda log: scaled(log, "commands", 3.6))
    assert found_in(with_runs(log, lambda run: replace(run, files=("all.csv",)))) == ()


def test_a_drive_at_one_speed_is_no_other_robot() -> None:
    steady = sound_log(replace(SKID_STEERED, seconds=90.0, seed=3, speeds=(1.0, 1.0)))
    assert found_in(together(lambda _: steady)) == ()


@pytest.mark.parametrize(
    ("change", "spoils", "what"),
    [
        (lambda log: scaled(log, "commands", 3.6), True, "d2.csv drives 26"),
        (lambda log: scaled(log, "commands", 0.6), False, "d2.csv drives 15"),
        (with_commands(lambda c: replace(c, omega=0.5 * c.omega)), False, "d2.csv turns 1"),
        (with_commands(lambda c: replace(c, v=c.v[::-1].copy())), True, "d2.csv drives otherwise than"),
    ],
    ids=["km/h", "another gear", "another turn", "of another drive"],
)
def test_the_file_that_is_otherwise_is_named(change: Callable[[Log], Log], spoils: bool, what: str) -> None:
    (found,) = found_in(together(change))
    assert (found.kind, found.spoils, found.reserves) == (KIND, spoils, not spoils)
    assert what in found.sentence


def test_files_in_which_nothing_turns_or_moves_divide_by_nothing() -> None:
    def stands(run: Run) -> Run:
        still = np.zeros(len(run.poses))
        return replace(run, poses=replace(run.poses, x=still, y=still, yaw=still))

    log = together(lambda log: log)
    others = tuple(stands(run) for run in log.runs[:2])
    (found,) = found_in(replace(log, runs=(*others, log.runs[2])))
    assert (found.spoils, "d2.csv drives" in found.sentence) == (True, True)


def test_a_verdict_says_it() -> None:
    other = together(with_commands(lambda c: replace(c, omega=0.5 * c.omega)))
    verdict = calibrate(other, input="command").verdict
    assert any("The log d2.csv turns" in each for each in verdict.reservations)
    alike = calibrate(together(lambda log: log), input="command").verdict
    assert not any("d2.csv" in each for each in alike.reservations)
