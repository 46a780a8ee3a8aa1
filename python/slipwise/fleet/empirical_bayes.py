# SPDX-License-Identifier: Apache-2.0
"""Normal-normal empirical Bayes: what robots of a type have in common, and each robot given that."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError

Floats = NDArray[np.float64]

ITERATIONS = 1000
TOLERANCE = 1e-4  # change of the between-robot variance, in units of it and of the smallest measured one
GUESSED = 2.0  # robots that a guess of their variances counts as
LEAST = 1e-12  # of the between-robot variance, in units of the smallest measured one


@dataclass(frozen=True, eq=False)
class FleetPrior:
    """theta_i ~ N(mean, between), measured as estimate_i ~ N(theta_i, covariance_i)."""

    mean: Floats  # [P]
    mean_covariance: Floats  # [P, P] of the mean
    between: Floats  # [P, P] of robots about it
    shrunk: Floats  # [N, P] each robot given all others
    shrunk_covariance: Floats  # [N, P, P] that of the mean included
    weight: Floats  # [N] how much each robot counts for what is common; 1 without the Student variant

    @property
    def new_robot(self) -> Floats:
        """Covariance [P, P] of a robot that nothing is known of but that it is of this type."""
        return self.between + self.mean_covariance


def fleet_prior(
    estimates: Floats,
    covariances: Floats,
    *,
    dof: float | None = None,
    guess: Floats | None = None,
) -> FleetPrior:
    """Fit mean and covariance of robots by expectation maximisation of the marginal likelihood.

    Args:
        estimates: [N, P] of at least two robots.
        covariances: [N, P, P] of the estimates.
        dof: degrees of freedom of a Student t of the robots, against one odd robot; None: they are normal.
        guess: [P] of the robots' variances, which counts as `GUESSED` robots; then these have one variance
            per parameter and no covariance, since few robots tell no more.

    Raises:
        SettingsError: there are fewer than two robots, or shapes do not fit.
    """
    count, size = estimates.shape if estimates.ndim == 2 else (0, 0)
    if count < 2 or covariances.shape != (count, size, size):
        raise SettingsError("a fleet needs two robots at least, with a covariance each")
    scale = np.sqrt(np.einsum("nii->ni", covariances).min(axis=0) + 1e-300)
    y, s = estimates / scale, covariances / np.outer(scale, scale)
    guessed = None if guess is None else guess / scale**2
    first = np.atleast_2d(np.cov(y.T)) if guessed is None else np.diag(guessed)
    between = first + LEAST * np.eye(size)
    weight = np.ones(count)
    for _ in range(ITERATIONS):
        before = between
        mean, _ = _mean(y, s, between, weight)
        between, weight = _step(y - mean, s, between, dof)
        if guessed is not None:
            between = np.diag((count * np.diag(between) + GUESSED * guessed) / (count + GUESSED))
        if np.abs(between - before).max() <= TOLERANCE * (1.0 + np.abs(before).max()):
            break
    mean, mean_covariance = _mean(y, s, between, weight)
    shrunk, shrunk_covariance = _shrunk(y, s, (mean, mean_covariance), between / weight[:, None, None])
    unit = np.outer(scale, scale)
    return FleetPrior(
        mean * scale,
        mean_covariance * unit,
        between * unit,
        shrunk * scale,
        shrunk_covariance * unit,
        weight,
    )


def _inverse(matrices: Floats) -> Floats:
    """Return inverses; those of numbers, of which there are many, without LAPACK."""
    if matrices.shape[-1] == 1:
        found: Floats = 1.0 / matrices
        return found
    return np.asarray(np.linalg.inv(matrices), dtype=np.float64)


def _times(matrices: Floats, vectors: Floats) -> Floats:
    """Return products [N, P] of matrices [N, P, P] and vectors [N, P]."""
    found: Floats = (matrices @ vectors[..., np.newaxis])[..., 0]
    return found


def _mean(y: Floats, s: Floats, between: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Return the precision-weighted mean [P] and its covariance."""
    precision = _inverse(s + between / weight[:, None, None])
    covariance = _inverse(precision.sum(axis=0))
    return covariance @ _times(precision, y).sum(axis=0), covariance


def _step(apart: Floats, s: Floats, between: Floats, dof: float | None) -> tuple[Floats, Floats]:
    """Return the next between-robot covariance, restricted maximum likelihood, and the weights of robots."""
    count, size = apart.shape
    weight = np.ones(count)
    if dof is not None:
        distance = (apart * _times(_inverse(s + between), apart)).sum(axis=1)
        weight = (dof + size) / (dof + distance)
    prior = between / weight[:, None, None]
    total = _inverse(s + prior)
    gain = prior @ total
    expected = _times(gain, apart)
    left = prior - gain @ prior  # covariance of each robot given its estimate and the mean
    of_mean = _inverse(total.sum(axis=0))
    left = left + gain @ of_mean @ np.swapaxes(gain, 1, 2)  # the mean is estimated: divide by less than N
    second = expected[:, :, np.newaxis] * expected[:, np.newaxis] + left
    following = (weight[:, None, None] * second).sum(axis=0) / count
    return following + LEAST * np.eye(size), weight


def _shrunk(y: Floats, s: Floats, mean: tuple[Floats, Floats], prior: Floats) -> tuple[Floats, Floats]:
    """Return robots given the fleet, and their covariance: that of the fleet's mean and variance included."""
    centre, of_centre = mean
    gain = prior @ _inverse(s + prior)
    rest = np.eye(y.shape[1]) - gain
    shrunk = centre + _times(gain, y - centre)
    covariance = gain @ s + rest @ of_centre @ np.swapaxes(rest, 1, 2)
    pulled = _times(rest, y - centre)
    freedom = max(1.0, len(y) - y.shape[1] - 2.0)
    covariance = (
        covariance + 2.0 / freedom * pulled[:, :, np.newaxis] * pulled[:, np.newaxis]
    )  # Morris (1983)
    return shrunk, 0.5 * (covariance + np.swapaxes(covariance, 1, 2))
