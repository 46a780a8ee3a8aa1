# SPDX-License-Identifier: Apache-2.0
"""A small part of `benchmarks/promises/terrain_change.py`: large steps of yaw slip, from wheel speeds."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.promises.disturbed_robot import Robot, TerrainChange, disturbed_run
from benchmarks.promises.terrain_change import MEAN, WORST, Job, geometric_mean, judge


def test_runs_are_the_same_until_the_terrain_changes() -> None:
    (same,), (other,) = (
        disturbed_run(Robot(), 1.0, seed=3, change=change).log.runs
        for change in (None, TerrainChange(30.0, 0.5))
    )
    assert same.poses is not None
    assert other.poses is not None
    early = same.poses.t < 30.0
    assert (same.poses.yaw[early] == other.poses.yaw[early]).all()
    assert np.abs(np.sin(same.poses.yaw - other.poses.yaw)).max() > 0.1


@pytest.mark.slow
def test_large_steps_of_yaw_slip_are_found_or_forgotten() -> None:
    found = [judge(Job("0.05", "wheel", factor, seed)) for factor in (0.5, 1.5) for seed in (0, 1)]
    ratios = [each.ratio for each in found]
    assert geometric_mean(ratios) <= MEAN
    assert max(ratios) <= WORST
    assert sum(each.alarms for each in found) == 0
    assert all(each.delay is not None for each in found)
