# SPDX-License-Identifier: Apache-2.0
"""Drift of a parameter as a random walk in the distance driven: how fast, how sure, and where it is now."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEWEST = 6  # logs, below which a walk cannot be distinguished from scatter
_STEPS = 41  # of the grid in each of the two variances, over eight decades
_DECADES = (-5.0, 3.0)  # of a variance, in units of the smallest measured one


@dataclass(frozen=True)
class Walk:
    """theta_k = theta_k-1 + N(0, rate * metres between), measured as theta_k + N(0, std_k^2 + scatter)."""

    rate: float  # variance per metre, in the parameter's unit squared
    scatter: float  # variance of logs beyond what they say themselves, such as by ground
    level: float  # the parameter after the last log
    level_std: float
    log_likelihood: float  # at the best rate and scatter, of all logs but the first
    chance: float  # p-value of "it stays as it is"


def random_walk(metres: Floats, values: Floats, stds: Floats) -> Walk | None:
    """Fit a random walk with scatter by maximum likelihood (a Kalman filter with an unknown start).

    The test against a rate of zero is the likelihood ratio; at the edge of what is possible its chi-square
    counts half (Self and Liang 1987).

    Args:
        metres: [N] driven until each log's middle, not falling.
        values: [N] of the parameter.
        stds: [N] of the values.

    Returns:
        The walk; None for fewer than `FEWEST` logs, or where nothing was driven between them.
    """
    if len(values) < FEWEST or not np.ptp(metres) > 0.0:
        return None
    unit = float(np.min(stds)) ** 2
    grid = np.concatenate(([0.0], np.logspace(*_DECADES, _STEPS))) * unit
    way = np.diff(metres) / float(np.mean(np.diff(metres)))
    rate, scatter = (axis.ravel() for axis in np.meshgrid(grid, grid, indexing="ij"))
    likelihood, level, variance = filtered((way, values, stds), rate, scatter)
    best = int(np.argmax(likelihood))
    still = float(likelihood[rate == 0.0].max())
    ratio = 2.0 * max(float(likelihood[best]) - still, 0.0)
    return Walk(
        rate=float(rate[best]) / float(np.mean(np.diff(metres))),
        scatter=float(scatter[best]),
        level=float(level[best]),
        level_std=math.sqrt(float(variance[best])),
        log_likelihood=float(likelihood[best]),
        chance=0.5 * math.erfc(math.sqrt(0.5 * ratio)) if ratio > 0.0 else 1.0,
    )


def filtered(
    series: tuple[Floats, Floats, Floats], rate: Floats, scatter: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return log likelihood, last level and its variance of a random walk, for each of some candidates [C].

    The first log sets the level, so that the likelihood is of the others.

    Args:
        series: way between logs [N - 1], values [N] and their standard deviations [N].
        rate: [C] variance per unit of way.
        scatter: [C] variance of logs beyond their standard deviations.
    """
    way, values, stds = series
    level, variance = np.full(len(rate), values[0]), stds[0] ** 2 + scatter
    likelihood = np.zeros(len(rate))
    for step, value, std in zip(way, values[1:], stds[1:], strict=True):
        variance = variance + rate * step
        total = variance + std**2 + scatter
        off = value - level
        likelihood -= 0.5 * (np.log(2.0 * math.pi * total) + off**2 / total)
        gain = variance / total
        level, variance = level + gain * off, (1.0 - gain) * variance
    return likelihood, level, variance
