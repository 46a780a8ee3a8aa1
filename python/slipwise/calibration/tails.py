# SPDX-License-Identifier: Apache-2.0
"""How large and how heavy-tailed the errors of held-out predictions are, beside what the covariance said."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from slipwise.student import LEAST_DOF, MOST_DOF, share_inside

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# The prior: ln(scale) and ln(dof) are normal. A log of some ten held-out windows outweighs it.
PRIOR_SCALE, PRIOR_SCALE_STD = 1.0, 0.7  # median and standard deviation of the logarithm
PRIOR_DOF, PRIOR_DOF_STD = 8.0, 0.8
# Windows after which an error is forgotten; the covariance that the tails correct changes while the filter
# learns, on some drives fast and on others not at all. The last forgets nothing.
MEMORIES = (10.0, 30.0, 100.0, math.inf)
MATCHED = (0.50, 0.95)  # shares whose ellipsoids the point estimate takes over from the posterior

_STEP = 0.1  # of the logarithms of scale and squared distance
_SCALES = np.arange(math.log(0.01), math.log(1000.0), _STEP)  # logarithms
_DOFS = np.array([LEAST_DOF, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 30.0, MOST_DOF])
_DISTANCES = np.arange(math.log(0.01) - 2.0, math.log(1000.0) + 6.0, _STEP)  # logarithms of squared ones
_FARTHEST = 1e12  # a squared distance counts at most this, so that it stays a number
_CHUNK = 128  # windows at a time, so that memory does not grow with the log


@dataclass(frozen=True, eq=False)
class Tails:
    """A multivariate Student t per prediction, [N] each."""

    growth: Floats  # factor of the covariance
    dof: Floats  # degrees of freedom, LEAST_DOF to MOST_DOF


def learn_tails(known: Ints, squared: Floats) -> Tails:
    """Fit the t of each prediction to the errors of the `known` first held-out windows.

    The posterior over a grid of scale and degrees of freedom is a mixture of t; the t returned is the one
    with the mixture's 50 % and 95 % ellipsoids. How fast older windows are forgotten is weighed among
    `MEMORIES` by how well each foretold the windows so far (derivations.md, section 5).

    Args:
        known: number of windows whose errors were known at each prediction, [N], each at most M.
        squared: squared Mahalanobis lengths of the windows' errors in their stated covariances, [M].
    """
    growth, dof = np.empty(len(known)), np.empty(len(known))
    prior = _log_prior()
    evidence, foretold = np.zeros((len(MEMORIES), len(prior))), np.zeros(len(MEMORIES))
    for first in range(0, len(squared) + 1, _CHUNK):
        steps = _log_likelihood(squared[first : first + _CHUNK])
        beliefs = []
        for k, memory in enumerate(MEMORIES):
            gathered = _gathered(evidence[k], steps, memory)
            weights = _normalised(prior + gathered)
            beliefs.append(_Belief(weights, foretold[k] + _log_foretold(weights, steps)))
            evidence[k], foretold[k] = gathered[-1], beliefs[k].foretold[-1]
        at = np.flatnonzero((known >= first) & (known < first + _CHUNK))
        if len(at):
            counts, back = np.unique(known[at], return_inverse=True)
            scale, degrees = _with_same_ellipsoids(_mixed(beliefs)[counts - first])
            growth[at], dof[at] = (scale * degrees / (degrees - 2.0))[back], degrees[back]
    return Tails(growth, dof)


@dataclass(frozen=True, eq=False)
class _Belief:
    """What one memory makes of the windows, before and after each of N."""

    weights: Floats  # [N + 1, S * D] posterior over the grid
    foretold: Floats  # [N + 1] logarithm of the density that it gave to all windows so far


def _log_foretold(weights: Floats, steps: Floats) -> Floats:
    """Logarithm of the density that was given to windows before they were seen, added up, [N + 1]."""
    most = steps.max(axis=1, keepdims=True)
    density = np.log((weights[:-1] * np.exp(steps - most)).sum(axis=1)) + most[:, 0]
    return np.concatenate(([0.0], np.cumsum(density)))


def _mixed(beliefs: list[_Belief]) -> Floats:
    """The posterior over memories and grid, summed over the memories, [N + 1, S * D]."""
    shares = _normalised(np.column_stack([belief.foretold for belief in beliefs]))
    mixed = np.zeros_like(beliefs[0].weights)
    for k, belief in enumerate(beliefs):
        mixed += shares[:, k, None] * belief.weights
    return mixed


def _gathered(evidence: Floats, steps: Floats, memory: float) -> Floats:
    """Evidence before and after each window [N, S * D], older windows counting less, [N + 1, S * D]."""
    gathered = np.empty((len(steps) + 1, evidence.size))
    gathered[0] = evidence
    for i, step in enumerate(steps):
        gathered[i + 1] = (1.0 - 1.0 / memory) * gathered[i] + step
    return gathered


def _log_prior() -> Floats:
    """Logarithm of the prior over the grid, [S * D], up to a constant."""
    scale = (_SCALES - math.log(PRIOR_SCALE)) / PRIOR_SCALE_STD
    dof = (np.log(_DOFS) - math.log(PRIOR_DOF)) / PRIOR_DOF_STD
    return np.asarray(-0.5 * np.add.outer(scale**2, dof**2).ravel(), dtype=np.float64)


def _log_likelihood(squared: Floats) -> Floats:
    """Logarithm of each window's density over the grid, [N, S * D], up to a constant."""
    distance = np.minimum(squared, _FARTHEST)[:, None, None] * np.exp(-_SCALES)[:, None]
    constant = [math.lgamma((nu + 3.0) / 2.0) - math.lgamma(nu / 2.0) - 1.5 * math.log(nu) for nu in _DOFS]
    density = np.array(constant) - 0.5 * (_DOFS + 3.0) * np.log1p(distance / _DOFS)
    whole = (density - 1.5 * _SCALES[:, None]).reshape(len(squared), len(_SCALES) * len(_DOFS))
    return np.asarray(whole, dtype=np.float64)


def _normalised(logarithms: Floats) -> Floats:
    """Probabilities from their logarithms up to a constant, row by row, [N, K]."""
    weights = np.exp(logarithms - logarithms.max(axis=1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=1, keepdims=True), dtype=np.float64)


def _with_same_ellipsoids(weights: Floats) -> tuple[Floats, Floats]:
    """Scale and degrees of freedom of the t that has the mixture's ellipsoids, [N] each.

    Where the mixture's tails are heavier than `LEAST_DOF` allows, the larger ellipsoid is kept.
    """
    table = _mixture_table()
    inside = np.array([row @ table for row in weights])  # row by row: the same bits however many rows
    inner, outer = (_crossing(inside, share) for share in MATCHED)
    known = _ellipsoid_table()
    dof = np.interp(inner - outer, known.inner - known.outer, known.dof)
    return np.exp(outer - np.interp(dof, known.dof, known.outer)), dof


def _crossing(inside: Floats, share: float) -> Floats:
    """Logarithm of the squared distance at which each row of shares reaches `share`, [N]."""
    row = np.arange(len(inside))
    after = np.clip((inside < share).sum(axis=1), 1, inside.shape[1] - 1)
    low, high = inside[row, after - 1], inside[row, after]
    return np.asarray(_DISTANCES[after - 1] + _STEP * (share - low) / (high - low), dtype=np.float64)


@cache
def _mixture_table() -> Floats:
    """Share within each of `_DISTANCES` for every point of the grid, [S * D, K].

    It depends on the quotient of distance and scale alone, and both lie on the same steps.
    """
    quotients = _DISTANCES[0] - _SCALES[0] + _STEP * np.arange(1 - len(_SCALES), len(_DISTANCES))
    inside = _share_within(np.exp(quotients), _DOFS)
    place = np.arange(len(_DISTANCES)) - np.arange(len(_SCALES))[:, None] + len(_SCALES) - 1
    return np.asarray(inside[:, place].transpose(1, 0, 2).reshape(-1, len(_DISTANCES)), dtype=np.float64)


@dataclass(frozen=True, eq=False)
class _EllipsoidTable:
    """Logarithms of the squared sizes of the `MATCHED` ellipsoids in the scale matrix, [D] each."""

    dof: Floats
    inner: Floats
    outer: Floats


@cache
def _ellipsoid_table() -> _EllipsoidTable:
    dof = np.geomspace(LEAST_DOF, MOST_DOF, 60)
    logarithms = np.linspace(-2.0, 5.0, 281)
    inside = _share_within(np.exp(logarithms), dof)
    inner, outer = (np.array([np.interp(share, row, logarithms) for row in inside]) for share in MATCHED)
    return _EllipsoidTable(dof, inner, outer)


def _share_within(squared: Floats, dof: Floats) -> Floats:
    """Share within squared distances in the scale matrix, [D, K]."""
    return share_inside(np.outer((dof - 2.0) / dof, squared), dof[:, None])
