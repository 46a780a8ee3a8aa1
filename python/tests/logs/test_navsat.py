# SPDX-License-Identifier: Apache-2.0
"""Tests of the local tangent plane and of headings for satellite fixes."""

import numpy as np
import pytest

from slipwise.logs import Inputs
from slipwise.logs.navsat import angles_at, east_north_up, ecef, heading_from_path, tilt_from_imu


def test_earth_centred_positions_on_the_axes() -> None:
    points = ecef(np.array([0.0, 0.0, 90.0]), np.array([0.0, 90.0, 0.0]), np.array([0.0, 100.0, 0.0]))
    expected = [[6378137.0, 0.0, 0.0], [0.0, 6378237.0, 0.0], [0.0, 0.0, 6356752.314245]]
    np.testing.assert_allclose(points, expected, atol=1e-6)


@pytest.mark.parametrize("latitude", [-60.0, 0.0, 48.0])
def test_small_steps_follow_the_radii_of_curvature(latitude: float) -> None:
    step = 1e-4
    lat = np.array([latitude, latitude + step, latitude])
    lon = np.array([9.0, 9.0, 9.0 + step])
    local = east_north_up(lat, lon, np.zeros(3))
    e2, sine = 6.69437999014e-3, np.sin(np.radians(latitude))
    meridian = 6378137.0 * (1 - e2) / (1 - e2 * sine**2) ** 1.5
    normal = 6378137.0 / np.sqrt(1 - e2 * sine**2)
    north, east = meridian * np.radians(step), normal * np.cos(np.radians(latitude)) * np.radians(step)
    np.testing.assert_allclose(local[0], 0.0, atol=1e-12)
    np.testing.assert_allclose(local[1, :2], [0.0, north], atol=2e-4)
    np.testing.assert_allclose(local[2, :2], [east, 0.0], atol=2e-4)


def test_up_is_up() -> None:
    local = east_north_up(np.array([48.0, 48.0]), np.array([9.0, 9.0]), np.array([300.0, 310.0]))
    np.testing.assert_allclose(local[1], [0.0, 0.0, 10.0], atol=1e-8)


def test_the_heading_is_turned_about_when_driving_backward() -> None:
    t = np.linspace(0.0, 9.0, 10)
    back = Inputs(t=t, v=np.full(10, -1.0), vy=np.zeros(10), omega=np.zeros(10))
    yaw, known = heading_from_path(t, np.negative(t), np.zeros(10), back)
    assert known.all()
    np.testing.assert_allclose(np.cos(yaw), 1.0)


def test_a_parked_robot_has_no_course() -> None:
    rng = np.random.default_rng(0)
    noise = rng.normal(scale=0.02, size=(2, 100))
    _, known = heading_from_path(np.linspace(0.0, 5.0, 100), noise[0], noise[1], None)
    assert not known.any()


def test_slow_driving_at_a_high_rate_has_a_course() -> None:
    t = np.linspace(0.0, 10.0, 201)
    yaw, known = heading_from_path(t, 0.5 * t, 0.5 * t, None)
    assert known.all()
    np.testing.assert_allclose(yaw, 0.25 * np.pi)


def test_imu_headings_are_followed_through_half_a_turn_and_not_made_up_across_a_gap() -> None:
    imu_t, imu_yaw = np.array([0.0, 0.2, 5.0]), np.array([3.1, -3.1, 0.0])
    yaw, near = angles_at(np.array([0.1, 2.5]), imu_t, imu_yaw)
    assert near.tolist() == [True, False]
    assert abs(abs(yaw[0]) - np.pi) < 1e-9


def test_tilts_of_the_imu_are_interpolated_and_not_made_up_across_a_gap() -> None:
    imu_t, pitch = np.array([0.0, 0.2, 5.0]), np.array([0.1, 0.3, 0.0])
    found = tilt_from_imu(np.array([0.1, 2.5]), imu_t, pitch)
    assert found[0] == pytest.approx(0.2)
    assert np.isnan(found[1])
