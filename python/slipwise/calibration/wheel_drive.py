# SPDX-License-Identifier: Apache-2.0
"""Runs as the wheels tell them: the drive behind the commands, and the path the wheels alone would make."""

from __future__ import annotations

from dataclasses import replace

from slipwise.calibration.drive import DriveRun, input_track
from slipwise.logs.dead_reckoning import dead_reckoned
from slipwise.logs.log import Inputs


def has_wheels(drive: tuple[DriveRun, ...]) -> bool:
    """Whether every run has wheel speeds beside its commands."""
    return all(run.wheels is not None and len(run.wheels) > 1 for run in drive)


def wheel_runs(drive: tuple[DriveRun, ...]) -> tuple[DriveRun, ...]:
    """Return the same runs with the wheels as inputs: from them to the poses there is only slip."""
    return tuple(
        replace(run, inputs=_wheels(run), track=input_track(_wheels(run), rolling=True), wheels=None)
        for run in drive
    )


def chain_runs(drive: tuple[DriveRun, ...]) -> tuple[DriveRun, ...]:
    """Return the same runs with the wheels' own path for poses: from the commands to it there is no slip."""
    return tuple(replace(run, run=replace(run.run, poses=dead_reckoned(_wheels(run)))) for run in drive)


def _wheels(run: DriveRun) -> Inputs:
    assert run.wheels is not None
    return run.wheels
