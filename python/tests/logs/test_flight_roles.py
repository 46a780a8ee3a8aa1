# SPDX-License-Identifier: Apache-2.0
"""Held values, angles between samples, headings as yaw, and wheels from distances."""

from __future__ import annotations

import numpy as np

from slipwise.logs.flight_roles import between, held, wheels_from_distances, yaw_from_heading


def test_the_last_value_is_held_and_before_the_first_there_is_none() -> None:
    found = held(np.array([0.0, 1.0, 1.5, 9.0]), np.array([1.0, 2.0]), np.array([5.0, 6.0]))
    np.testing.assert_array_equal(found, [np.nan, 5.0, 5.0, 6.0])
    assert np.isnan(held(np.zeros(2), np.empty(0), np.empty(0))).all()


def test_angles_are_interpolated_the_short_way_round() -> None:
    found = between(np.array([0.25]), np.array([0.0, 0.5]), np.radians([170.0, -170.0]))
    np.testing.assert_allclose(np.abs(found), np.pi)


def test_an_angle_that_is_too_far_away_is_none() -> None:
    assert np.isnan(between(np.array([2.0]), np.array([0.0, 1.0]), np.zeros(2))).all()
    assert np.isnan(between(np.array([0.0]), np.array([0.0]), np.array([np.nan]))).all()


def test_north_east_south_and_west_as_yaw() -> None:
    found = yaw_from_heading(np.radians([0.0, 90.0, 180.0, 270.0]))
    np.testing.assert_allclose(np.degrees(found), [90.0, 0.0, -90.0, -180.0], atol=1e-9)


def test_a_twist_holds_until_the_next_distance() -> None:
    t = np.array([0.0, 1.0, 1.0, 3.0])
    stream = wheels_from_distances(
        "W", t, np.array([0.0, 1.0, 1.0, 5.0]), np.array([0.0, 2.0, 2.0, 6.0]), separation=0.5
    )
    assert stream is not None
    np.testing.assert_allclose(stream.t, [0.0, 1.0])
    np.testing.assert_allclose(stream.columns["v"], [1.5, 2.0])
    np.testing.assert_allclose(stream.columns["omega"], [2.0, 0.0], atol=1e-12)
    assert wheels_from_distances("W", t[:1], t[:1], t[:1], 0.5) is None


def test_stamps_that_go_back_give_no_twist_there() -> None:
    t = np.array([5.0, 3.0, 5.0, 6.0])
    found = wheels_from_distances("wheels", t, np.arange(4.0), np.arange(4.0), 0.5)
    assert found is not None
    assert found.t.tolist() == [5.0]
    assert found.columns["v"].tolist() == [1.0]
    assert wheels_from_distances("wheels", np.array([5.0, 3.0, 5.0]), t[:3], t[:3], 0.5) is None
