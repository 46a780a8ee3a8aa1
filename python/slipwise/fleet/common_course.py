# SPDX-License-Identifier: Apache-2.0
"""What all vehicles of a fleet do alike over time, such as by the season: it is no wear of one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipwise.fleet.correlated import Series

Floats = NDArray[np.float64]

FEWEST_OTHERS = 3  # vehicles that tell a course from what one of them does
_MOST_BINS = 12
_ROUNDS = 5


def without_common_course(all_series: Sequence[Series]) -> list[Series]:
    """Return the series less what the others do alike.

    The course is the median of the other vehicles about their levels, in bins of time with straight lines
    between. It is shrunk by how much of it is the vehicles' own scatter, so that a fleet without one loses
    nothing; where too few others drove it is taken from the nearest times.
    """
    if len(all_series) <= FEWEST_OTHERS:
        return list(all_series)
    edges = _edges(all_series)
    return [
        _less(series, [other for k, other in enumerate(all_series) if k != place], edges)
        for place, series in enumerate(all_series)
    ]


def _edges(all_series: Sequence[Series]) -> Floats:
    days = np.concatenate([series.days for series in all_series])
    count = int(np.clip(np.median([len(series.days) for series in all_series]), 2, _MOST_BINS))
    return np.linspace(days.min(), days.max() * (1.0 + 1e-12), count + 1)


def _less(series: Series, others: Sequence[Series], edges: Floats) -> Series:
    middles = 0.5 * (edges[1:] + edges[:-1])
    bins = [
        np.clip(np.searchsorted(edges, other.days, side="right") - 1, 0, len(middles) - 1) for other in others
    ]
    course = np.zeros(len(middles))
    kept = 0.0
    for _ in range(_ROUNDS):
        binned = np.full((len(others), len(middles)), np.nan)
        for row, other, places in zip(binned, others, bins, strict=True):
            left = other.values - np.interp(other.days, middles, course)
            about = other.values - np.average(left, weights=other.stds**-2.0)
            drives = np.bincount(places, minlength=len(row))
            np.divide(np.bincount(places, about, len(row)), drives, out=row, where=drives > 0)
        counts = np.isfinite(binned).sum(axis=0)
        there = counts >= FEWEST_OTHERS
        if there.sum() < 2:
            return series
        median = _median(binned[:, there], counts[there])
        spread = np.nanvar(binned[:, there], axis=0, ddof=1)
        noise = float(np.mean(0.5 * np.pi * spread / counts[there]))
        seen = float(np.var(median))
        kept = max(0.0, 1.0 - noise / seen) if seen > 0.0 else 0.0
        course = np.interp(middles, middles[there], median - median.mean())
    return replace(series, values=series.values - kept * np.interp(series.days, middles, course))


def _median(columns: Floats, counts: NDArray[np.int64]) -> Floats:
    """Return medians of columns, each of so many numbers; the rest of a column is NaN."""
    ordered, column = np.sort(columns, axis=0), np.arange(columns.shape[1])
    found: Floats = 0.5 * (ordered[(counts - 1) // 2, column] + ordered[counts // 2, column])
    return found
