# SPDX-License-Identifier: Apache-2.0
"""How much logs differ beyond what they say: of each vehicle, helped by what all vehicles have in common."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEWEST_VEHICLES = 3  # whose scatters say how alike vehicles are
_SMALLEST = 1e-6  # of a ratio of variances: logs that lie on a line do not make all others exact
_ASYMPTOTIC = 10.0  # from which the series of digamma and trigamma are exact to 1e-10


def shared_scatter(excess: Floats, freedom: Floats) -> tuple[Floats, Floats]:
    """Return each vehicle's variance and its degrees of freedom, given all vehicles (Smyth 2004).

    Variances of vehicles are scaled inverse chi-square about a common one; how alike they are is learned from
    how much they differ beyond what few logs let them. Vehicles that are all alike count as one with the logs
    of all; a vehicle unlike the others keeps its own.

    Args:
        excess: [V] variance about the line, in units of what the logs say themselves.
        freedom: [V] its degrees of freedom, at least one.
    """
    if len(excess) < FEWEST_VEHICLES:
        return excess, freedom
    half = 0.5 * freedom
    log = np.log(np.maximum(excess, _SMALLEST)) - np.array([digamma(h) - math.log(h) for h in half])
    spread = float(np.var(log, ddof=1) - np.mean([trigamma(h) for h in half]))
    total = float(freedom.sum())
    if spread <= 0.0:
        return np.full(len(excess), float(np.sum(freedom * excess)) / total), np.full(len(excess), total)
    prior_half = _inverse_trigamma(spread)
    prior = math.exp(float(np.mean(log)) + digamma(prior_half) - math.log(prior_half))
    known = 2.0 * prior_half
    return (known * prior + freedom * excess) / (known + freedom), np.minimum(known + freedom, total)


def digamma(x: float) -> float:
    """Return the derivative of log gamma at a positive number, by its asymptotic series."""
    shifted = 0.0
    while x < _ASYMPTOTIC:
        shifted, x = shifted - 1.0 / x, x + 1.0
    y = 1.0 / (x * x)
    return shifted + math.log(x) - 0.5 / x - y * (1 / 12 - y * (1 / 120 - y * (1 / 252 - y / 240)))


def trigamma(x: float) -> float:
    """Return the second derivative of log gamma at a positive number, by its asymptotic series."""
    shifted = 0.0
    while x < _ASYMPTOTIC:
        shifted, x = shifted + 1.0 / (x * x), x + 1.0
    y = 1.0 / (x * x)
    return shifted + (1.0 + 0.5 / x + y * (1 / 6 - y * (1 / 30 - y * (1 / 42 - y / 30)))) / x


def _inverse_trigamma(value: float) -> float:
    """Return where trigamma has a positive value; it falls, so that halving an interval finds it."""
    low, high = -15.0, 15.0  # of the logarithm
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if trigamma(math.exp(middle)) > value else (low, middle)
    return math.exp(0.5 * (low + high))
