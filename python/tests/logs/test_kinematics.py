# SPDX-License-Identifier: Apache-2.0
"""Body twists from wheel speeds, curvatures and steering angles."""

import numpy as np
import pytest

from slipwise.logs.findings.finding import RefusedLogError
from slipwise.logs.kinematics import omega_from_curvature, twist_from_steering, twist_from_wheels


def test_equal_wheels_drive_straight_and_opposite_ones_turn_on_the_spot() -> None:
    left, right = np.array([10.0, -10.0]), np.array([10.0, 10.0])
    v, omega = twist_from_wheels(left, right, wheel_radius=0.1, wheel_separation=0.5)
    np.testing.assert_allclose(v, [1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(omega, [0.0, 4.0], atol=1e-15)


def test_a_faster_right_side_turns_to_the_left() -> None:
    _, omega = twist_from_wheels(np.array([5.0]), np.array([6.0]), wheel_radius=0.2, wheel_separation=0.8)
    assert omega[0] == pytest.approx(0.2 * 1.0 / 0.8)


def test_a_curvature_turns_backwards_when_the_robot_backs_up() -> None:
    np.testing.assert_allclose(
        omega_from_curvature(np.array([2.0, -2.0, 0.0]), np.array([0.5, 0.5, 9.0]), speed_factor=1.0),
        [1.0, -1.0, 0.0],
    )


def test_a_steered_car_turns_about_the_point_that_its_wheelbase_and_angle_give() -> None:
    steer = np.array([0.3, -0.3, 0.0])
    v, omega = twist_from_steering(np.full(3, 4.0), steer, wheelbase=2.5, speed_factor=1.0)
    np.testing.assert_array_equal(v, 4.0)
    np.testing.assert_allclose(omega, 4.0 * np.tan(steer) / 2.5, atol=1e-15)


def test_a_steered_car_that_stands_keeps_how_its_wheels_are_turned() -> None:
    steer = np.array([0.3, 0.0, np.nan])
    v, omega = twist_from_steering(np.zeros(3), steer, wheelbase=2.5, speed_factor=1.0)
    assert 0.0 < v[0] < 1e-8
    assert omega[0] / v[0] == pytest.approx(np.tan(0.3) / 2.5)
    assert (v[1], omega[1]) == (0.0, 0.0)
    assert not np.isfinite(omega[2])


def test_angles_in_degrees_are_refused_and_sharp_ones_are_not() -> None:
    v, steer = np.full(100, 4.0), 0.35 * np.sin(np.arange(100.0))
    with pytest.raises(RefusedLogError, match=r"look like degrees \(up to 20\.1: .*convert them to radians"):
        twist_from_steering(v, np.degrees(steer), wheelbase=2.5, speed_factor=1.0)
    for angles in (4.0 * steer, np.where(np.arange(100) % 20 == 0, 20.0, steer)):  # sharp, with a few spikes
        twist_from_steering(v, angles, wheelbase=2.5, speed_factor=1.0)
