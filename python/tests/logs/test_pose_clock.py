# SPDX-License-Identifier: Apache-2.0
"""The offset between two clocks is found from the motion that both saw, or refused where it is unclear."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, held, simulated_run, steady_run

from slipwise import _core
from slipwise.errors import LogError
from slipwise.logs import Inputs, Poses, Run
from slipwise.logs.pose_clock import ClockMatch, find_clock_offset, pose_motion

SKID = Drive(basis=_core.named_basis("edd-2"), alpha=(-0.05, -0.4), lag=0.4, delay=0.2, pose_std=(0.02, 0.01))
HALF_STEP = 0.025  # [s] the simulated wheel speeds are those at the start of what they are held for


def found(run: Run, inputs: Inputs, away: float, *, lagging: bool = False) -> ClockMatch:
    poses = run.poses
    motion = pose_motion(poses.t - away, poses.x, poses.y, poses.yaw)
    return find_clock_offset([inputs], motion, 0.5, lagging=lagging)


@pytest.mark.parametrize("away", [0.0, 12.345, -4321.0, 1.7e9])
def test_any_offset_is_found_from_wheels_to_hundredths_of_a_second(away: float) -> None:
    run = simulated_run(SKID)
    assert run.wheels is not None
    match = found(run, run.wheels, away)
    assert match.offset - HALF_STEP == pytest.approx(away, abs=0.015)
    assert match.agreement > 0.95
    assert match.next_best < 0.6


def test_from_commands_the_lag_is_no_part_of_the_offset_and_the_delay_is() -> None:
    run = simulated_run(SKID)
    assert run.commands is not None
    match = found(run, run.commands, 7.0, lagging=True)
    assert match.offset == pytest.approx(7.0 - 0.2, abs=0.05)


def test_poses_of_a_part_of_the_drive_and_outliers_do_not_matter() -> None:
    run = simulated_run(SKID)
    assert run.wheels is not None
    part = slice(800, 2000, 3)
    x = np.array(run.poses.x[part])
    x[[20, 150]] += 30.0
    motion = pose_motion(run.poses.t[part] + 55.5, x, run.poses.y[part], run.poses.yaw[part])
    match = find_clock_offset([run.wheels], motion, 0.5, lagging=False)
    assert match.offset - HALF_STEP == pytest.approx(-55.5, abs=0.03)


def test_stray_stamps_years_away_do_not_matter() -> None:
    run = simulated_run(SKID)
    assert run.wheels is not None
    w, p = run.wheels, run.poses
    columns = (
        np.concatenate([[first], column])
        for first, column in ((-1e9, w.t), (0, w.v), (0, w.vy), (0, w.omega))
    )
    t, x, y, yaw = (
        np.concatenate([column, [last]]) for column, last in ((p.t, 1e9), (p.x, 0), (p.y, 0), (p.yaw, 0))
    )
    match = find_clock_offset([Inputs(*columns)], pose_motion(t, x, y, yaw), 0.5, lagging=False)
    assert match.offset - HALF_STEP == pytest.approx(0.0, abs=0.015)


def test_positions_without_a_heading_are_enough() -> None:
    run = simulated_run(SKID)
    assert run.wheels is not None
    poses = run.poses
    motion = pose_motion(poses.t - 3.0, poses.x, poses.y, np.full(len(poses), np.nan))
    match = find_clock_offset([run.wheels], motion, 0.5, lagging=False)
    assert match.offset - HALF_STEP == pytest.approx(3.0, abs=0.03)


def test_a_drive_that_repeats_is_ambiguous() -> None:
    t = np.arange(0.0, 200.0, 0.05)
    omega = np.where((t // 5.0) % 2 == 0, 0.5, -0.5)
    inputs = Inputs(t=t, v=np.full(len(t), 1.0), vy=np.zeros(len(t)), omega=omega)
    yaw = np.concatenate([[0.0], np.cumsum(omega * 0.05)[:-1]])
    x, y = np.cumsum(np.cos(yaw) * 0.05), np.cumsum(np.sin(yaw) * 0.05)
    motion = pose_motion(t, x, y, yaw)
    with pytest.raises(LogError, match=r"several offsets of clocks fit equally.*--pose-clock-offset"):
        find_clock_offset([inputs], motion, 0.5, lagging=False)


def test_another_drive_or_steady_motion_does_not_fit() -> None:
    run, other = simulated_run(SKID), simulated_run(Drive(seed=9))
    assert run.wheels is not None
    with pytest.raises(LogError, match=r"does not fit|fit equally"):
        found(other, run.wheels, 0.0)
    steady = steady_run(60.0)
    with pytest.raises(LogError, match=r"less than 20 s of changing motion to compare"):
        found(steady, held(np.arange(0.0, 60.0, 0.05)), 0.0)


def test_motion_is_taken_between_poses_that_are_near() -> None:
    poses = Poses(
        t=np.array([0.0, 0.01, 0.4, 5.0, 5.4]),
        x=np.array([0.0, 9.0, 0.4, 50.0, 50.4]),
        y=np.zeros(5),
        yaw=np.array([3.1, 0.0, -3.1, 0.0, 0.1]),
        frame=np.zeros(5, np.int64),
    )
    motion = pose_motion(poses.t, poses.x, poses.y, poses.yaw)
    assert motion.start.tolist() == [0.0, 5.0]
    np.testing.assert_allclose(motion.speed, [1.0, 1.0])
    np.testing.assert_allclose(motion.rate, [(2.0 * np.pi - 6.2) / 0.4, 0.25])
