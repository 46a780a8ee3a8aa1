# SPDX-License-Identifier: Apache-2.0
"""Grades and maps of elevations: which way they tilt a robot, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.ground import ElevationMap, Grade

NOWHERE = np.zeros((1, 3))


def test_a_robot_that_looks_downhill_has_its_nose_down_and_one_that_looks_across_leans() -> None:
    grade = Grade(slope=0.2, downhill=1.0)
    _, roll, pitch = grade.under((0.0, 0.0, 1.0)).standings(NOWHERE)[0]
    assert (roll, pitch) == pytest.approx((0.0, 0.2))
    # Downhill is to the right of it, so that its right side is low: a positive roll.
    _, roll, pitch = grade.under((0.0, 0.0, 1.0 + math.pi / 2)).standings(NOWHERE)[0]
    assert (roll, pitch) == pytest.approx((0.2, 0.0))


def test_a_grade_falls_downhill() -> None:
    grade = Grade(slope=0.1, downhill=0.5)
    down = np.array([[math.cos(0.5), math.sin(0.5), 0.0]])
    assert grade.under((0.0, 0.0, 0.0)).standings(down)[0, 0] == pytest.approx(-math.tan(0.1))


def test_a_map_of_a_plane_stands_as_the_grade_does() -> None:
    grade = Grade(slope=0.15, downhill=-0.7)
    rise = np.array(grade.rise(0.0))
    x, y = np.meshgrid(np.arange(-5.0, 5.5, 0.5), np.arange(-4.0, 4.5, 0.5))
    made = ElevationMap(rise[0] * x + rise[1] * y, origin=(-5.0, -4.0), cell=0.5)
    poses = np.array([[1.0, 0.5, 0.3], [0.0, 2.0, -2.0]])
    start = (0.5, -1.0, 1.1)
    assert made.under(start).standings(poses) == pytest.approx(grade.under(start).standings(poses))


@pytest.mark.parametrize("slope", [-0.1, 1.2, math.nan, math.inf])
def test_a_slope_that_is_none_is_refused(slope: float) -> None:
    with pytest.raises(SettingsError, match="is not a grade"):
        Grade(slope=slope)
    with pytest.raises(SettingsError, match="is not a grade"):
        Grade(slope=0.1, downhill=math.nan)


def test_a_map_that_is_none_is_refused() -> None:
    hole = np.zeros((3, 3))
    hole[1, 1] = math.nan
    row, flat = np.zeros((1, 4)), np.zeros((3, 3))
    for elevation, cell in ((row, 1.0), (hole, 1.0), (flat, 0.0), (row[0], 1.0)):
        with pytest.raises(SettingsError):
            ElevationMap(elevation, origin=(0.0, 0.0), cell=cell)
    with pytest.raises(SettingsError):
        ElevationMap([["high"]], origin=(0.0, 0.0), cell=1.0)  # type: ignore[arg-type]


def test_a_path_beside_the_map_is_refused() -> None:
    made = ElevationMap(np.zeros((3, 3)), origin=(0.0, 0.0), cell=1.0)
    made.check(np.array([[0.0, 0.0, 1.0], [2.0, 2.0, 1.0]]))
    with pytest.raises(SettingsError, match="leads beside the map"):
        made.check(np.array([[0.0, 0.0, 1.0], [2.1, 2.0, 1.0]]))
    with pytest.raises(SettingsError, match="begins beside the map"):
        made.under((-1.0, 0.0, 0.0))
