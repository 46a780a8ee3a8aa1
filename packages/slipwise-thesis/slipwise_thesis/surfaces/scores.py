# SPDX-License-Identifier: Apache-2.0
"""Scores of slip surfaces on examples they have not learned: error, log score and coverage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise_thesis.surfaces.examples import SlipExamples
from slipwise_thesis.surfaces.surface import SlipSurface, SurfacePrediction

Floats = NDArray[np.float64]

LEVELS = (0.5, 0.9, 0.95)
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)
_FAR = 30.0  # scales; beyond it a probability is one


@dataclass(frozen=True, eq=False)
class SurfaceScore:
    """Means over N examples, per channel (lon, lat, ang)."""

    examples: int
    error: Floats  # [3] mean absolute (m/s, m/s, rad/s)
    log_score: Floats  # [3] mean log of the predictive density at what was measured; higher is better
    coverage: Floats  # [len(LEVELS), 3] fraction of examples inside the central intervals of LEVELS


def score_surface(surface: SlipSurface, held_out: SlipExamples) -> SurfaceScore:
    """Score a fitted surface on examples that it has not learned.

    The log score is not a number where a standard deviation is not positive, and minus infinity where it
    is infinite.
    """
    prediction = surface.predict(held_out.v, held_out.omega)
    error = held_out.slip - prediction.mean
    scale = _scales(prediction)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = np.abs(error) / np.where(scale > 0.0, scale, np.nan)
        log_density = np.column_stack([_log_density(z[:, c], nu) for c, nu in enumerate(prediction.freedom)])
        log_score = (log_density - np.log(scale)).mean(axis=0)
    inside = np.column_stack([central_probability(z[:, c], nu) for c, nu in enumerate(prediction.freedom)])
    coverage = np.array([(inside < level).mean(axis=0) for level in LEVELS])
    return SurfaceScore(len(held_out), np.abs(error).mean(axis=0), log_score, coverage)


def central_probability(z: Floats, freedom: float) -> Floats:
    """P(|t| < z) of Student's t, by quadrature over atan(z / sqrt(freedom)); Gaussian at infinity."""
    if math.isinf(freedom):
        return np.array([math.erf(value / math.sqrt(2.0)) for value in z.tolist()])
    far = np.minimum(z, _FAR * math.sqrt(1.0 + 30.0 / freedom))
    half = 0.5 * np.arctan(far / math.sqrt(freedom))
    angles = half[:, None] * (1.0 + _NODES)
    constant = math.lgamma(0.5 * (freedom + 1.0)) - math.lgamma(0.5 * freedom)
    integral = half * (np.cos(angles) ** (freedom - 1.0) @ _WEIGHTS)
    return np.asarray(2.0 / math.sqrt(math.pi) * math.exp(constant) * integral, dtype=np.float64)


def _scales(prediction: SurfacePrediction) -> Floats:
    nu = prediction.freedom
    with np.errstate(invalid="ignore"):
        shrink = np.where(np.isinf(nu), 1.0, np.sqrt((nu - 2.0) / nu))
    return np.asarray(prediction.std * shrink, dtype=np.float64)


def _log_density(z: Floats, freedom: float) -> Floats:
    if math.isinf(freedom):
        return np.asarray(-0.5 * np.square(z) - 0.5 * math.log(2.0 * math.pi), dtype=np.float64)
    constant = (
        math.lgamma(0.5 * (freedom + 1.0)) - math.lgamma(0.5 * freedom) - 0.5 * math.log(freedom * math.pi)
    )
    return np.asarray(constant - 0.5 * (freedom + 1.0) * np.log1p(np.square(z) / freedom), dtype=np.float64)
