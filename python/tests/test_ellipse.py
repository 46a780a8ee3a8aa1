# SPDX-License-Identifier: Apache-2.0
"""Covariance ellipses."""

from __future__ import annotations

import numpy as np

from slipwise.ellipse import ellipse
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
