# SPDX-License-Identifier: Apache-2.0
"""Statistics over held-out errors: summaries, block-bootstrap intervals, ratios, NIS and coverage."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Shares = tuple[float, float, float]  # within the 50, 90 and 95 % ellipsoids

RESAMPLES = 1000
LARGEST_CHUNK = 1 << 16  # starts of blocks drawn at a time: they stay in the cache, and memory does not grow
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
    """The windows that are scored: the second half in time (derivations/uncertainty.md)."""
    return slice(count // 2, count)


def resampled_sums(values: Floats) -> Floats:
    """Sums over circular block bootstrap samples (Politis and Romano 1992), [RESAMPLES].

    Values of the same length are resampled alike. Few of them are resampled in shorter blocks, of one value
    at least: a block of all would show no spread.
    """
    rng, count = np.random.default_rng(SEED), len(values)
    block = max(1, min(BLOCK_WINDOWS, count // 4))
    blocks = -(-count // block)
    whole = _block_sums(values, block)
    last = _block_sums(values, count - (blocks - 1) * block)  # cut off, so that a sample has `count` values
    rows = max(1, LARGEST_CHUNK // blocks)
    sums = []
    for first in range(0, RESAMPLES, rows):
        starts = rng.integers(0, count, size=(min(rows, RESAMPLES - first), blocks))
        sums.append(whole[starts[:, :-1]].sum(axis=1) + last[starts[:, -1]])
    return np.concatenate(sums)


def _block_sums(values: Floats, length: int) -> Floats:
    """Sum of the `length` values from each on, past the end from the beginning again, [N]."""
    return np.asarray(np.sum([np.roll(values, -k) for k in range(length)], axis=0), dtype=np.float64)


def summarise(errors: Floats) -> ErrorSummary:
    """Summarise the errors of at least one window."""
    means = resampled_sums(errors) / len(errors)
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
    denominators = resampled_sums(reference)
    usable = denominators > 0.0
    ratios = resampled_sums(errors)[usable] / denominators[usable]
    low, high = np.quantile(ratios, (0.025, 0.975))
    return (float(errors.sum() / reference.sum()), float(low), float(high))


def nis_band(count: int) -> tuple[float, float]:
    """Where the mean NIS of `count` independent windows lies with 95 %."""
    return chi_square_band(count, 3)


def chi_square_band(count: int, degrees: int) -> tuple[float, float]:
    """Where the mean of `count` independent chi-squares of `degrees` lies with 95 % (Wilson-Hilferty)."""
    spread = 2.0 / (9.0 * degrees * count)
    low, high = (
        (1.0 - spread + z * np.sqrt(spread)) ** 3 * degrees for z in (-1.959963984540054, 1.959963984540054)
    )
    return (float(low), float(high))


def share_interval(share: float, count: int) -> tuple[float, float]:
    """95 % interval of a probability of which `count` independent trials show `share` (Wilson 1927)."""
    z = 1.959963984540054
    middle = (share + z * z / (2.0 * count)) / (1.0 + z * z / count)
    width = z * np.sqrt(share * (1.0 - share) / count + z * z / (4.0 * count * count)) / (1.0 + z * z / count)
    return (float(middle - width), float(middle + width))


def coverage(inside: Floats) -> Shares:
    """Fraction of windows inside the 50, 90 and 95 % ellipsoids of their t, from `Predictions.inside`."""
    return _shares(inside, ELLIPSOIDS)


def normal_coverage(nis: Floats) -> Shares:
    """Fraction of windows inside the 50, 90 and 95 % ellipsoids of a normal distribution."""
    return _shares(nis, ELLIPSOIDS.values())


def _shares(values: Floats, limits: Iterable[float]) -> Shares:
    half, nine_tenths, most = (float(np.mean(values <= limit)) for limit in limits)
    return (half, nine_tenths, most)
