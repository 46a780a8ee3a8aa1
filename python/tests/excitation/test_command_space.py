# SPDX-License-Identifier: Apache-2.0
"""Command spaces hold commands within their limits and refuse limits that are none."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.excitation import CommandSpace


def test_grid_reaches_the_limits_and_leaves_out_what_is_too_quick_in_a_turn() -> None:
    grid = CommandSpace(3.0, 2.0, 4.0).grid(4)
    assert np.abs(grid).max(axis=0).tolist() == [3.0, 0.0, 2.0]
    assert np.abs(grid[:, 0] * grid[:, 2]).max() <= 4.0 + 1e-9
    assert [2.0, 0.0, 2.0] in grid.tolist()
    assert [3.0, 0.0, 2.0] not in grid.tolist()


def test_quadrant_goes_forwards_and_left_and_never_stands() -> None:
    quadrant = CommandSpace(1.0, 1.0).quadrant(3)
    assert (quadrant >= 0.0).all()
    assert len(quadrant) == 8


def test_a_robot_that_drives_sideways_is_commanded_so_to_both_sides_and_mixed() -> None:
    space = CommandSpace(1.0, 1.0, sideways=0.5)
    aside = space.grid(3)[space.grid(3)[:, 1] != 0.0]
    assert sorted(set(aside[:, 1].tolist())) == [-0.5, 0.5]
    assert [0.0, 0.5, 0.0] in aside.tolist()
    assert [1.0, -0.5, -1.0] in aside.tolist()
    assert (space.quadrant(3) >= 0.0).all()
    assert {0.25, 0.5} <= set(space.quadrant(3)[:, 1].tolist())
    assert np.hypot(*CommandSpace(1.0, 1.0, 0.6, 0.5).grid(3)[:, :2].T).max() > 1.1  # without turning


def test_slower_space_has_a_fraction_of_the_limits() -> None:
    assert CommandSpace(2.0, 1.0, 3.0).slower(0.25, 0.5) == CommandSpace(0.5, 0.5, 3.0)


def test_limit_that_is_none_is_refused(subtests: pytest.Subtests) -> None:
    for limits in [(0.0, 1.0), (1.0, -1.0), (math.nan, 1.0), (math.inf, 1.0), (1.0, 1.0, 0.0)]:
        with subtests.test(limits=limits), pytest.raises(SettingsError, match="the limit"):
            CommandSpace(*limits)


def test_a_robot_that_steers_is_commanded_no_tighter_turn() -> None:
    grid = CommandSpace(2.0, 1.0, curvature=0.5).grid(3)
    assert (np.abs(grid[:, 2]) <= 0.5 * np.abs(grid[:, 0]) + 1e-9).all()
    assert [2.0, 0.0, 1.0] in grid.tolist()
