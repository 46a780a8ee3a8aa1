# SPDX-License-Identifier: Apache-2.0
"""Covariance ellipses."""

from __future__ import annotations

import numpy as np

from slipwise.reporting.ellipse import RADIUS_95, ellipse


def test_outline_has_the_mahalanobis_radius_of_95_percent() -> None:
    covariance = np.array([[0.04, 0.015], [0.015, 0.01]])
    outline = ellipse(np.array([1.0, 2.0]), covariance)
    assert outline is not None
    offset = outline - [1.0, 2.0]
    squared = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(covariance), offset)
    assert np.allclose(squared, RADIUS_95**2)


def test_95_percent_of_normal_points_lie_inside_the_radius() -> None:
    points = np.random.default_rng(1).normal(size=(200_000, 2))
    assert abs(np.mean(np.hypot(*points.T) < RADIUS_95) - 0.95) < 0.002


def test_what_is_no_covariance_has_no_ellipse() -> None:
    assert ellipse(np.zeros(2), np.array([[1.0, 2.0], [2.0, 1.0]])) is None
    assert ellipse(np.zeros(2), np.full((2, 2), np.nan)) is None
    assert ellipse(np.array([np.nan, 0.0]), np.eye(2)) is None
