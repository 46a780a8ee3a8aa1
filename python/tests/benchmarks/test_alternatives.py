# SPDX-License-Identifier: Apache-2.0
"""Mechanisms beside alternatives: what is left out at a limit, and which damaged logs get a good model."""

from __future__ import annotations

import alternatives_of_motion
import numpy as np
import pytest
from alternatives import Beside, halves
from alternatives_of_poses import start_ratio
from alternatives_of_verdicts import good
from contradictory_logs import scaled, sound_log
from disturbed_robot import Robot, disturbed_run

from slipwise.models.limits import AxisLimitsSection, LearnedLimit, LimitsSection


def test_means_are_geometric_over_logs() -> None:
    beside = Beside("limits", "none", "real", ((2.0, 0.5), (0.5, 2.0)))
    assert beside.mean == pytest.approx((1.0, 1.0))


def test_poses_at_a_limit_and_a_second_after_it_are_left_out_and_never_joined() -> None:
    log = disturbed_run(Robot(), 1.0, seed=1).log
    free = AxisLimitsSection()
    fast = AxisLimitsSection(saturation=LearnedLimit(value=0.9, std=0.01))
    limits = LimitsSection(
        speed=fast,
        yaw_rate=free,
        side=free,
        wheel_separation=0.6,
        wheel_separation_std=0.1,
        gain_v=1.0,
        gain_omega=1.0,
    )
    (run,) = alternatives_of_motion.within(log, limits).runs
    (before,) = log.runs
    assert run.commands is not None
    at_limit = run.commands.t[np.abs(run.commands.v) >= 0.9]
    since = run.poses.t[:, None] - at_limit
    assert 0 < len(run.poses) < len(before.poses)
    assert not ((since >= 0.0) & (since < 0.95)).any()
    gap = np.diff(run.poses.t) > 0.5
    assert gap.any()
    assert (np.diff(run.poses.frame)[gap] != 0).all()


def test_the_filtered_start_is_held_against_the_measured_one() -> None:
    first, _ = halves(disturbed_run(Robot(pose_std=(0.05, 0.03)), 3.0, seed=2).log)
    position, heading = start_ratio(first)
    assert 0.3 < position < 1.2
    assert 0.3 < heading < 1.5


def test_evidence_refuses_what_held_out_errors_alone_would_take() -> None:
    assert good(sound_log()) == (True, True)
    assert not good(scaled(sound_log(), "wheels", -1.0))[0]
