# SPDX-License-Identifier: Apache-2.0
"""Covariance ellipses."""

from __future__ import annotations

import numpy as np

from slipwise.ellipse import ellipse, outline_of
from slipwise.student import ellipse_squared


def test_outline_has_the_mahalanobis_radius_of_95_percent() -> None:
    covariance = np.array([[0.04, 0.015], [0.015, 0.01]])
    outline = ellipse(np.array([1.0, 2.0]), covariance, 5.0)
    assert outline is not None
    offset = outline - [1.0, 2.0]
    squared = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(covariance), offset)
    assert np.allclose(squared, ellipse_squared(0.95, 5.0))


def test_what_is_no_covariance_has_no_ellipse() -> None:
    assert ellipse(np.zeros(2), np.array([[1.0, 2.0], [2.0, 1.0]]), 5.0) is None
    assert ellipse(np.zeros(2), np.full((2, 2), np.nan), 5.0) is None
    assert ellipse(np.array([np.nan, 0.0]), np.eye(2), 5.0) is None


def test_an_ellipse_that_is_flat_to_rounding_is_a_line() -> None:
    ends = np.array([[4.03394781e-30, -8.96432847e-31], [-8.96432847e-31, 1.99207299e-31]])
    assert np.linalg.det(ends / ends[0, 0]) < 0.0
    outline = outline_of(np.array([1.41053162, 0.33787062]), ends, 1.0)
    assert outline is not None
    assert np.isfinite(outline).all()
    direction = np.array([1.0, -0.2222])
    flat = outline_of(np.zeros(2), np.outer(direction, direction), 1.0)
    assert flat is not None
    across = np.array([-direction[1], direction[0]])
    assert np.abs(flat @ across).max() < 1e-6
