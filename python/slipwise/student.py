# SPDX-License-Identifier: Apache-2.0
"""Student's t around a predicted pose: which share its ellipsoids hold, and how far they reach.

Squared distances are Mahalanobis lengths in the covariance (as the NIS is), not in the scale matrix; the
covariance is dof / (dof - 2) times the scale matrix.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

LEAST_DOF = 2.5  # degrees of freedom; with 2 and less there is no covariance
MOST_DOF = 100.0  # as good as normal
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)
_CHUNK = 4096  # distances at a time, so that memory does not grow with the log
_FARTHEST = 1e6  # squared distance that every ellipsoid asked for lies within


def fraction_inside(squared: ArrayLike, dof: ArrayLike) -> Floats:
    """Probability of x, y, yaw to lie within a squared distance, [N]; 3 squared / dof is Fisher's F(3, dof).

    With a radius of √dof tan θ in the scale matrix, the density over θ is sin² θ cos^(dof - 1) θ; Gauss's
    quadrature of it is exact to 1e-12 between `LEAST_DOF` and `MOST_DOF`.
    """
    distances, degrees = np.broadcast_arrays(np.atleast_1d(squared), np.atleast_1d(dof))
    distances, degrees = distances.astype(np.float64), degrees.astype(np.float64)
    parts = [slice(first, first + _CHUNK) for first in range(0, distances.size, _CHUNK)]
    flat = [_share(distances.ravel()[part], degrees.ravel()[part]) for part in parts]
    return np.concatenate([np.empty(0), *flat]).reshape(distances.shape)


def _share(squared: Floats, dof: Floats) -> Floats:
    half = 0.5 * np.arctan(np.sqrt(squared / (dof - 2.0)))
    angle = half[:, None] * (1.0 + _NODES)
    density = np.sin(angle) ** 2 * np.cos(angle) ** (dof[:, None] - 1.0)
    whole = np.exp([math.lgamma(1.5) + math.lgamma(nu / 2.0) - math.lgamma((nu + 3.0) / 2.0) for nu in dof])
    return np.asarray(2.0 * half * (density @ _WEIGHTS) / whole, dtype=np.float64)


def ellipsoid_squared(fraction: float, dof: float) -> float:
    """Squared distance in x, y, yaw within which `fraction` lies, by bisection."""
    low, high = 0.0, _FARTHEST
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(fraction_inside(middle, dof)[0]) < fraction else (low, middle)
    return high


def ellipse_squared(fraction: float, dof: float) -> float:
    """Squared distance in two of the coordinates within which `fraction` lies: F(2, dof) in closed form."""
    return float((dof - 2.0) * math.expm1(-2.0 / dof * math.log1p(-fraction)))
