# SPDX-License-Identifier: Apache-2.0
"""Ellipsoids of Student's t: beside tabulated quantiles, and beside draws."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.student import ellipse_squared, ellipsoid_squared, fraction_inside

# 95 % quantiles of Fisher's F, as any table prints them: degrees of freedom, F(3, dof), F(2, dof).
TABLE = [
    (3.0, 9.2766, 9.5521),
    (5.0, 5.4095, 5.7861),
    (10.0, 3.7083, 4.1028),
    (30.0, 2.9223, 3.3158),
    (100.0, 2.6955, 3.0873),
]


def test_ellipsoids_are_those_of_the_tables_of_f(subtests: pytest.Subtests) -> None:
    for dof, three, two in TABLE:
        with subtests.test(dof=dof, three=three, two=two):
            to_covariance = (dof - 2.0) / dof
            assert float(fraction_inside(3.0 * three * to_covariance, dof)[0]) == pytest.approx(
                0.95, abs=5e-6
            )
            assert ellipsoid_squared(0.95, dof) == pytest.approx(3.0 * three * to_covariance, rel=5e-5)
            assert ellipse_squared(0.95, dof) == pytest.approx(2.0 * two * to_covariance, rel=5e-5)


def test_share_goes_from_nothing_to_all_and_has_the_shape_of_its_input() -> None:
    squared = np.array([0.0, 1e-3, 1.0, 10.0, 1e3, 1e12])
    for dof in (2.5, 3.0, 17.0, 100.0):
        fraction = fraction_inside(squared, dof)
        assert (np.diff(fraction) >= -1e-12).all()
        assert fraction[0] == 0.0
        assert fraction[-1] == pytest.approx(1.0, abs=1e-9)
    assert fraction_inside(np.ones((2, 3)), 5.0).shape == (2, 3)
    assert fraction_inside(np.empty(0), np.empty(0)).shape == (0,)


def test_ellipses_of_position_hold_their_share_of_draws() -> None:
    rng, dof = np.random.default_rng(1), 4.0
    draws = rng.normal(size=(200_000, 2)) * np.sqrt((dof - 2.0) / rng.chisquare(dof, (200_000, 1)))
    squared = (draws**2).sum(axis=1)  # the covariance is the identity
    assert abs(np.mean(squared < ellipse_squared(0.95, dof)) - 0.95) < 0.002
