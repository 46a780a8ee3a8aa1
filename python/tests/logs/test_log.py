# SPDX-License-Identifier: Apache-2.0
"""Tests that a log cannot hold a series that contradicts itself."""

import numpy as np
import pytest

from slipwise.errors import LogError
from slipwise.logs import Inputs, Poses, empty_poses

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
