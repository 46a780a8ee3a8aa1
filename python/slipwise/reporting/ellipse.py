# SPDX-License-Identifier: Apache-2.0
"""The outline of a covariance ellipse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Square root of the 95 % quantile of chi-square with two degrees of freedom: sqrt(-2 ln 0.05).
RADIUS_95 = float(np.sqrt(-2.0 * np.log(0.05)))


def ellipse(
    centre: Floats, covariance: Floats, points: int = 49, *, radius: float = RADIUS_95
) -> Floats | None:
    """Return the outline [points, 2] of the 95 % ellipse; None where the covariance [2, 2] is none.

    Args:
        centre: x, y [m].
        covariance: of x, y [m^2].
        points: of the closed outline.
        radius: in standard deviations.
    """
    if not (np.isfinite(covariance).all() and np.isfinite(centre).all()):
        return None
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    if values[0] < 0.0:
        return None
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.asarray(centre + radius * (circle * np.sqrt(values)) @ vectors.T)
