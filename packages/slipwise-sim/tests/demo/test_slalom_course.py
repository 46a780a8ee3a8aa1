# SPDX-License-Identifier: Apache-2.0
"""The course: smooth turns to both sides, a floor for every x, another course for another seed."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_sim.demo.slalom_course import FLOORS, SIDE, SPEED, slalom_course

SLOWEST_TURN = 0.43  # [rad/s] what 1 rad/s leaves on the floor that slips most


def test_a_course_turns_to_both_sides_and_goes_along_x() -> None:
    points = slalom_course(1).points
    assert (np.diff(points[:, 0]) > 0.0).all()
    assert points[:, 1].max() > SIDE[0] - 0.01
    assert points[:, 1].min() < 0.01 - SIDE[0]
    assert np.abs(points[:, 1]).max() <= SIDE[1]
    assert points[0] == pytest.approx((0.0, 0.0))


def test_the_robot_can_turn_as_a_course_asks_on_every_floor() -> None:
    for seed in range(20):
        x, y = slalom_course(seed).points.T
        slope = np.gradient(y, x)
        curvature = np.gradient(slope, x) / (1.0 + slope**2) ** 1.5
        assert np.abs(curvature).max() * SPEED < SLOWEST_TURN


def test_floors_follow_one_another_along_x() -> None:
    course = slalom_course(1, stretch=20.0)
    assert [course.floor_at(x) for x in (-1.0, 0.0, 19.9, 20.1, 39.9, 40.1, 1000.0)] == [0, 0, 0, 1, 1, 2, 2]
    assert course.floors == FLOORS
    assert course.points[-1, 0] == pytest.approx(60.0)


def test_a_seed_draws_its_course() -> None:
    assert np.array_equal(slalom_course(3).points, slalom_course(3).points)
    assert not np.array_equal(slalom_course(3).points, slalom_course(4).points)


def test_impossible_courses_are_refused() -> None:
    with pytest.raises(SettingsError, match="no course can be made of 0 floors"):
        slalom_course(1, floors=())
    with pytest.raises(SettingsError, match="of 1 m"):
        slalom_course(1, stretch=1.0)
    with pytest.raises(SettingsError, match="seed -1"):
        slalom_course(-1)
