# SPDX-License-Identifier: Apache-2.0
"""Tests that a log cannot hold a series that contradicts itself."""

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs import Inputs, Poses, Run, empty_poses

ONE = np.ones(3)
T = np.array([0.0, 1.0, 2.0])


def test_inputs_with_a_stamp_twice_are_refused() -> None:
    with pytest.raises(LogError, match=r"Inputs\.t does not increase \(entry 2\)"):
        Inputs(t=np.array([0.0, 1.0, 1.0]), v=ONE, vy=ONE, omega=ONE)


def test_inputs_of_different_lengths_are_refused() -> None:
    with pytest.raises(LogError, match="has 2 entries where t has 3"):
        Inputs(t=T, v=ONE[:2], vy=ONE, omega=ONE)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_pose_that_is_not_finite_is_refused(bad: float) -> None:
    with pytest.raises(LogError, match=r"Poses\.yaw is not finite \(entry 1\)"):
        Poses(t=T, x=ONE, y=ONE, yaw=np.array([0.0, bad, 0.0]), frame=np.zeros(3, np.int64))


def test_an_unknown_deviation_is_allowed() -> None:
    poses = Poses(
        t=T, x=ONE, y=ONE, yaw=ONE, frame=np.zeros(3, np.int64), std_xy=np.array([0.1, np.nan, 0.1])
    )
    assert len(poses) == 3


def test_integers_in_place_of_numbers_are_refused() -> None:
    with pytest.raises(LogError, match="float64"):
        Inputs(t=T, v=np.ones(3, np.int64), vy=ONE, omega=ONE)


def test_no_poses_is_a_valid_series() -> None:
    assert len(empty_poses()) == 0


def test_a_place_in_a_run_counts_from_its_first_stamp_and_names_that_of_the_file() -> None:
    commands = Inputs(t=1.7e9 - 0.5 + T, v=ONE, vy=ONE, omega=ONE)
    poses = Poses(t=1.7e9 + T, x=ONE, y=ONE, yaw=ONE, frame=np.zeros(3, np.int64))
    run = Run("field", commands, None, poses)
    assert run.span == (1.7e9 - 0.5, 1.7e9 + 2.0)
    assert run.place(1.7e9 + 1.0) == "run field, 1.5 s from its start (t = 1700000001.000 s)"
    assert Run("bare", None, None, empty_poses()).span == (0.0, 0.0)
