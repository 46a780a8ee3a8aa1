# SPDX-License-Identifier: Apache-2.0
"""What is kept of wheel speeds for the search for limits does not grow with the drive, and misses nothing."""

from __future__ import annotations

import numpy as np
import pytest
from limited_drives import SIDES, wheels_behind

from slipwise.calibration.drive import DriveRun, input_track
from slipwise.calibration.recent_twists import LEAD_IN, PAUSE, SPACING, RecentTwists
from slipwise.logs.log import Inputs, Poses, Run
from slipwise.segments import WindowRules
from slipwise.simulation import steps_drive

MOST = 400
SHIFT = 100.0  # s of driving, and then a pause
PERIOD = 1.0 / 40.0


def repeated(inputs: Inputs, times: int, every: float) -> Inputs:
    """The same inputs again and again, each time `every` seconds later, with a stop in between."""
    t = np.concatenate([inputs.t + k * every for k in range(times)])
    columns = {name: np.tile(getattr(inputs, name), times) for name in ("v", "vy", "omega")}
    rest = np.arange(0.0, times * every, PERIOD)
    rest = rest[np.mod(rest, every) > SHIFT + PERIOD]
    order = np.argsort(np.concatenate((t, rest)), kind="stable")
    zeros = np.zeros(len(rest))
    return Inputs(
        t=np.concatenate((t, rest))[order],
        **{name: np.concatenate((column, zeros))[order] for name, column in columns.items()},
    )


def run_of(index: int, commands: Inputs, wheels: Inputs) -> DriveRun:
    zeros = np.zeros(len(wheels))
    poses = Poses(t=wheels.t, x=zeros, y=zeros, yaw=zeros, frame=zeros.astype(np.int64))
    run = Run(name=str(index), poses=poses, commands=commands, wheels=wheels)
    return DriveRun(index, run, commands, input_track(commands, rolling=False), wheels)


@pytest.fixture(scope="module")
def once() -> tuple[Inputs, Inputs]:
    commands = steps_drive(3, SHIFT)
    return commands, wheels_behind(SIDES, commands, 1)


def drive_of(once: tuple[Inputs, Inputs], times: int, pause: float) -> tuple[DriveRun, ...]:
    commands, wheels = (repeated(inputs, times, SHIFT + pause) for inputs in once)
    return tuple(run_of(k, commands, wheels) for k in range(2))


def most_kept(drive: tuple[DriveRun, ...], step: float) -> tuple[int, int]:
    """The largest numbers of twists and commands kept on the way, read every `step` seconds."""
    recent, most = RecentTwists(drive, WindowRules(), MOST), (0, 0)
    for k, run in enumerate(drive):
        for t in np.arange(step, float(run.inputs.t[-1]) + step, step).tolist():
            recent.read(k, t)
            twists, commands = recent.kept
            most = max(most[0], twists), max(most[1], commands)
    assert recent.count > 2 * MOST
    return most


@pytest.mark.parametrize("pause", [0.0, 5.0, 300.0])
def test_what_is_kept_does_not_grow_with_the_drive(once: tuple[Inputs, Inputs], pause: float) -> None:
    short, long = (most_kept(drive_of(once, times, pause), 1.0) for times in (2, 16))
    assert long[0] == short[0] == MOST
    # Each lap has the commands of another moment at its seam, so that their number is not quite the same.
    assert long[1] <= short[1] + 2
    stretches = 3  # at most, within MOST twists
    rate = max(1.0 / PERIOD, 1.0 / float(np.diff(once[0].t).min()))
    assert long[1] <= rate * (MOST * SPACING + stretches * (LEAD_IN + PAUSE))


def test_reading_in_steps_keeps_what_reading_at_once_keeps(once: tuple[Inputs, Inputs]) -> None:
    drive = drive_of(once, 3, 30.0)
    steps, whole = (RecentTwists(drive, WindowRules(), MOST) for _ in range(2))
    for t in np.arange(0.0, 250.0, 0.37).tolist():
        steps.read(1, t)
    whole.read(1, 0.37 * int(250.0 / 0.37))
    assert steps.count == whole.count
    assert steps.kept == whole.kept
    assert len(steps.records()) == len(whole.records())


def test_a_long_pause_begins_a_stretch_anew_and_its_commands_are_let_go(once: tuple[Inputs, Inputs]) -> None:
    drive = drive_of(once, 2, 300.0)
    recent = RecentTwists(drive, WindowRules(), 10**6)
    recent.read(0, float(drive[0].inputs.t[-1]))
    assert len(recent.records()) == 2
    twists, commands = recent.kept
    assert twists == recent.count
    assert commands < len(drive[0].inputs) - 250.0 / PERIOD


def test_commands_that_were_lost_begin_a_stretch_anew(once: tuple[Inputs, Inputs]) -> None:
    commands, wheels = once
    lost = (commands.t > 40.0) & (commands.t < 45.0)
    columns = (getattr(commands, name)[~lost] for name in ("t", "v", "vy", "omega"))
    gapped = Inputs(**dict(zip(("t", "v", "vy", "omega"), columns, strict=True)))
    recent = RecentTwists((run_of(0, gapped, wheels),), WindowRules(), 10**6)
    recent.read(0, SHIFT)
    assert len(recent.records()) == 2
