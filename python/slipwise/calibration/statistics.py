# SPDX-License-Identifier: Apache-2.0
"""Statistics over held-out errors: summaries, block-bootstrap intervals, ratios, NIS and coverage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RESAMPLES = 1000
BLOCK_WINDOWS = 3  # windows do not overlap, so a block of three is at least three horizons long
SEED = 20100830  # fixed, so that the same log gives the same intervals
# Quantiles of the chi-square distribution with 3 degrees of freedom.
ELLIPSOIDS = {0.50: 2.3659738843753377, 0.90: 6.251388631170325, 0.95: 7.814727903251179}


@dataclass(frozen=True)
class ErrorSummary:
    """One kind of error over the windows, with a 95 % block-bootstrap interval of its mean."""

    mean: float
    low: float
    high: float
    median: float
    rmse: float
    p95: float


def held_out_half(count: int) -> slice:
    """The windows that are scored: the second half in time (derivations.md, section 8)."""
    return slice(count // 2, count)


def resampled_indices(count: int) -> Ints:
    """Indices of circular block bootstrap samples (Politis and Romano 1992), [RESAMPLES, count].

    Few windows are resampled in shorter blocks, of one window at least: a block of all would show no spread.
    """
    rng = np.random.default_rng(SEED)
    block = max(1, min(BLOCK_WINDOWS, count // 4))
    blocks = -(-count // block)
    starts = rng.integers(0, count, size=(RESAMPLES, blocks))
    return (starts[:, :, None] + np.arange(block)).reshape(RESAMPLES, -1)[:, :count] % count


def summarise(errors: Floats) -> ErrorSummary:
    """Summarise the errors of at least one window."""
    means = errors[resampled_indices(len(errors))].mean(axis=1)
    low, high = np.quantile(means, (0.025, 0.975))
    return ErrorSummary(
        mean=float(errors.mean()),
        low=float(low),
        high=float(high),
        median=float(np.median(errors)),
        rmse=float(np.sqrt(np.mean(errors**2))),
        p95=float(np.quantile(errors, 0.95)),
    )


def ratio_of_means(errors: Floats, reference: Floats) -> tuple[float, float, float]:
    """Ratio of two mean errors with its 95 % interval; NaN where the reference is never wrong."""
    if reference.sum() == 0.0:
        return (float("nan"), float("nan"), float("nan"))
    samples = resampled_indices(len(errors))
    denominators = reference[samples].sum(axis=1)
    usable = denominators > 0.0
    ratios = errors[samples].sum(axis=1)[usable] / denominators[usable]
    low, high = np.quantile(ratios, (0.025, 0.975))
    return (float(errors.sum() / reference.sum()), float(low), float(high))


def nis_band(count: int) -> tuple[float, float]:
    """Where the mean NIS of `count` independent windows lies with 95 % (chi-square, Wilson-Hilferty)."""
    degrees = 3.0 * count
    spread = 2.0 / (9.0 * degrees)
    low, high = (
        (1.0 - spread + z * np.sqrt(spread)) ** 3 * 3.0 for z in (-1.959963984540054, 1.959963984540054)
    )
    return (float(low), float(high))


def coverage(nis: Floats) -> tuple[float, float, float]:
    """Share of windows inside the 50, 90 and 95 % ellipsoids."""
    inside = [float(np.mean(nis <= quantile)) for quantile in ELLIPSOIDS.values()]
    return (inside[0], inside[1], inside[2])
