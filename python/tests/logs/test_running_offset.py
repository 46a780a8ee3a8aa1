# SPDX-License-Identifier: Apache-2.0
"""The offset of clocks is followed through a drive, with its deviation, where the drive tells of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log
from sample_logs import Drive

from slipwise.logs import Inputs, Poses
from slipwise.logs.running_offset import EVERY, RunningOffset, running_offsets


def offsets_of(drive: Drive, name: str = "wheels", late: float = 0.0) -> tuple[RunningOffset, RunningOffset]:
    (run,) = sound_log(drive).runs
    inputs = getattr(run, name)
    assert isinstance(inputs, Inputs)
    poses = replace(run.poses, t=run.poses.t + late * (run.poses.t > 60.0))
    return running_offsets(inputs, poses, 0.5, lagging=name == "commands")


@pytest.mark.parametrize("name", ["wheels", "commands"])
@pytest.mark.parametrize("late", [0.0, 0.4])
def test_speeds_and_turns_each_show_how_late_poses_are(name: str, late: float) -> None:
    for each in offsets_of(replace(SKID_STEERED, seconds=120.0), name, late):
        assert len(each) >= 9
        assert np.diff(each.t).min() > 0.5 * EVERY
        before, after = each.offset[each.t < 50.0], each.offset[each.t > 70.0]
        assert np.median(before) - np.median(after) == pytest.approx(late, abs=0.07)
        assert np.abs(before - np.median(before)).max() < 6.0 * np.median(each.std) + 0.03


def test_a_drive_that_does_not_change_tells_nothing() -> None:
    for each in offsets_of(Drive(seconds=60.0, speeds=(1.0, 1.0), yaw_rates=(0.0, 0.0))):
        assert len(each) == 0


def test_too_few_poses_tell_nothing() -> None:
    none = np.empty(0)
    inputs = Inputs(*np.zeros((4, 1)))
    poses = Poses(none, none, none, none, np.empty(0, np.int64))
    assert [len(each) for each in running_offsets(inputs, poses, 0.5, lagging=False)] == [0, 0]
