# SPDX-License-Identifier: Apache-2.0
"""The outline of the ellipse that a predicted position lies in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise.student import ellipse_squared

Floats = NDArray[np.float64]

_FRACTION = 0.95
_POINTS = 49  # of the closed outline
_ROUNDING = 1e-9  # of the larger variance: what is flat to rounding may come out below zero


def ellipse(centre: Floats, covariance: Floats, dof: float) -> Floats | None:
    """Return the outline [points, 2] of a Student t's 95 % ellipse; None where the covariance is none.

    Args:
        centre: x, y [m].
        covariance: of x, y [m^2], [2, 2].
        dof: degrees of freedom.
    """
    return outline_of(centre, covariance, float(np.sqrt(ellipse_squared(_FRACTION, dof))))


def outline_of(centre: Floats, covariance: Floats, radius: float) -> Floats | None:
    """Return the closed outline [points, 2] at `radius` standard deviations; None where that is none."""
    if not (np.isfinite(covariance).all() and np.isfinite(centre).all()):
        return None
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    if values[0] < -_ROUNDING * abs(values[1]):
        return None
    angle = np.linspace(0.0, 2.0 * np.pi, _POINTS)
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.asarray(centre + radius * (circle * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)
