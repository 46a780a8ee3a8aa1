# SPDX-License-Identifier: Apache-2.0
"""Trend and random walk of a parameter over logs whose scatter lasts for several logs, as by their ground."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_KEPT = (0.0, 0.3, 0.5, 0.65, 0.8, 0.9)  # of the scatter, from one log to the next at the usual gap
_SIZES = np.concatenate(([0.0], np.logspace(-1.5, 3.0, 16)))  # variance of the scatter, of what logs say
_RATES = np.concatenate(([0.0], np.logspace(-3.0, 3.0, 19)))  # variance of a walk's step, of what logs say
_NONE = 0.6  # chance of no scatter, before anything is known,
_NONE_GUARDED = 0.2  # and for the level of a test, which has to hold where there is some
FEWEST_OF_WALK = 6  # logs, below which a walk cannot be told from scatter
_LONGEST_GAP = 10.0  # usual gaps, after which scatter is forgotten in any case
_ALONE = 1.0  # vehicles that "any scatter" counts as beside those of the fleet
_ROUNDS = 30


@dataclass(frozen=True, eq=False)
class Series:
    """A parameter of one vehicle over its logs, in the order of time."""

    days: Floats  # [N]
    metres: Floats  # [N] driven until each log's middle
    values: Floats  # [N]
    stds: Floats  # [N]

    @property
    def gaps(self) -> Floats:
        """Return the times between logs [N - 1], in units of the usual one."""
        gaps = np.diff(self.days)
        usual = float(np.median(gaps[gaps > 0.0])) if (gaps > 0.0).any() else 1.0
        return np.minimum(gaps / usual, _LONGEST_GAP)

    @property
    def walks(self) -> bool:
        """Return whether the logs tell a walk from scatter."""
        return len(self.values) >= FEWEST_OF_WALK and bool(np.ptp(self.metres) > 0.0)

    @property
    def unit(self) -> float:
        """Return the variance that a log says of itself, the middle one."""
        return float(np.median(self.stds)) ** 2


@dataclass(frozen=True)
class Trend:
    """A straight line over days: slope per day, its standard deviation, and the p-value of none."""

    slope: float
    std: float
    chance: float


@dataclass(frozen=True)
class Walk:
    """theta_k = theta_k-1 + N(0, rate * metres between), measured with the logs' scatter."""

    rate: float  # variance per metre, in the parameter's unit squared
    level: float  # the parameter after the last log
    level_std: float
    chance: float  # p-value of "it stays as it is"


def trends(all_series: Sequence[Series]) -> list[Trend]:
    """Return the trend of each vehicle, by least squares with the covariance of its scatter.

    Scatter is an AR(1) between logs. How large it is and how long it lasts is averaged over what the logs of
    the vehicle say (restricted likelihood), and what those of all vehicles say together: a distribution over
    candidates by expectation maximisation (Laird 1978), to which "any scatter" adds as much as one vehicle.
    The p-value expects more scatter, and that it lasts: so its level holds with few logs.

    Args:
        all_series: of vehicles with three logs or more, over some time.
    """
    if not all_series:
        return []
    fits = [_lines(series) for series in all_series]
    likelihoods = np.array([fit.likelihood for fit in fits])
    likely, guarded = _weights(likelihoods, _even()), _weights(likelihoods, _guarded())
    return [_averaged(*each) for each in zip(fits, likely, guarded, strict=True)]


def walks(all_series: Sequence[Series]) -> list[Walk]:
    """Return the random walk of each vehicle in the distance that it drove.

    The test against a rate of zero is the ratio of likelihoods, averaged over the scatter as in `trends`; at
    the edge of what is possible its chi-square counts half (Self and Liang 1987).

    Args:
        all_series: of vehicles with six logs or more, over some distance.
    """
    if not all_series:
        return []
    found = [_filtered(series) for series in all_series]
    shared = _shared(np.array([each.likelihood[0] for each in found]), _even())
    return [_walk(*each) for each in zip(all_series, found, shared, strict=True)]


@dataclass(frozen=True, eq=False)
class _Lines:
    likelihood: Floats  # [C]
    slope: Floats  # [C]
    variance: Floats  # [C]
    freedom: int


def _candidates() -> tuple[Floats, Floats]:
    """Return size [C] and what is kept [C] of each scatter; without scatter nothing is kept."""
    size, kept = (axis.ravel() for axis in np.meshgrid(_SIZES, np.array(_KEPT), indexing="ij"))
    there = (size > 0.0) | (kept == 0.0)
    return size[there], kept[there]


def _even() -> Floats:
    """Return the chance of each scatter [C] before anything is known: all that is there is as likely."""
    some = _candidates()[0] > 0.0
    return np.where(some, (1.0 - _NONE) / some.sum(), _NONE)


def _guarded() -> Floats:
    """Return the chance of each scatter [C] that holds a test's level where few logs do not show the scatter.

    Its standard deviation is as likely to be small as large (Gelman 2006), and what lasts weighs by its
    spectral density at frequency zero, since it makes false trends.
    """
    size, kept = _candidates()
    weight = np.sqrt(size) / (1.0 - kept) ** 2
    return np.where(size > 0.0, (1.0 - _NONE_GUARDED) * weight / weight.sum(), _NONE_GUARDED)


def _lines(series: Series) -> _Lines:
    """Fit a line for each candidate: innovations of values, level and time through one filter."""
    size, kept = _candidates()
    variance = size * series.unit
    days = series.days - series.days.mean()
    rows = np.stack([series.values - series.values.mean(), np.ones_like(days), days / np.ptp(days)])
    state = np.zeros((3, len(size)))  # of the scatter, given each row
    left = variance.copy()
    squares, log_total = np.zeros((3, 3, len(size))), np.zeros(len(size))
    for k, std in enumerate(series.stds):
        if k > 0:
            held = kept ** series.gaps[k - 1]
            state, left = state * held, left * held**2 + variance * (1.0 - held**2)
        total = left + std**2
        off = rows[:, k, None] - state
        squares += off[:, None] * off[None, :] / total
        log_total += np.log(total)
        gain = left / total
        state, left = state + gain * off, (1.0 - gain) * left
    a, b, c = squares[1, 1], squares[1, 2], squares[2, 2]
    determinant = a * c - b * b
    level = (c * squares[0, 1] - b * squares[0, 2]) / determinant
    slope = (a * squares[0, 2] - b * squares[0, 1]) / determinant
    rest = squares[0, 0] - level * squares[0, 1] - slope * squares[0, 2]
    likelihood = -0.5 * (log_total + np.log(determinant) + rest)
    per_day = 1.0 / float(np.ptp(days))
    return _Lines(likelihood, slope * per_day, a / determinant * per_day**2, len(days) - 2)


def _shared(likelihoods: Floats, before: Floats) -> Floats:
    """Return the distribution of the scatter of vehicles like each one, by what the others say [V, C]."""
    relative = np.exp(likelihoods - likelihoods.max(axis=1, keepdims=True))
    shared, weights = before, relative
    for _ in range(_ROUNDS):
        weights = relative * shared
        weights /= weights.sum(axis=1, keepdims=True)
        shared = (_ALONE * before + weights.sum(axis=0)) / (_ALONE + len(weights))
    return np.asarray((_ALONE * before + weights.sum(axis=0) - weights) / (_ALONE + len(weights) - 1))


def _weights(likelihoods: Floats, before: Floats) -> Floats:
    """Return the weights of the candidates [V, C] for each vehicle."""
    weights = np.exp(likelihoods - likelihoods.max(axis=1, keepdims=True)) * _shared(likelihoods, before)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _averaged(fit: _Lines, weight: Floats, guarded: Floats) -> Trend:
    slope = float(weight @ fit.slope)
    variance = float(weight @ (fit.variance + (fit.slope - slope) ** 2))
    z = np.abs(fit.slope) / np.sqrt(fit.variance)
    chance = sum(
        float(w) * math.erfc(each / math.sqrt(2.0)) for w, each in zip(guarded, z, strict=True) if w > 0
    )
    return Trend(slope, math.sqrt(variance), min(1.0, chance))


@dataclass(frozen=True, eq=False)
class _Walks:
    likelihood: Floats  # [R, C] of each rate and scatter
    level: Floats  # [R, C] after the last log
    variance: Floats  # [R, C]


def _filtered(series: Series) -> _Walks:
    """Filter the logs for each candidate; the states are the level, that walks, and the scatter.

    The first log sets the level, so that the likelihood is of the others.
    """
    size, kept = _candidates()
    unit, way = series.unit, np.diff(series.metres)
    way = way / float(np.mean(way))
    rate, scatter = _RATES[:, None] * unit, np.broadcast_to(size * unit, (len(_RATES), len(size)))
    level, other = np.full(scatter.shape, series.values[0]), np.zeros(scatter.shape)
    ll, lo, oo = series.stds[0] ** 2 + scatter, -scatter, scatter
    likelihood = np.zeros(scatter.shape)
    for step, gap, value, std in zip(way, series.gaps, series.values[1:], series.stds[1:], strict=True):
        held = kept**gap
        ll = ll + rate * step
        other, lo, oo = other * held, lo * held, oo * held**2 + scatter * (1.0 - held**2)
        of_level, of_other = ll + lo, lo + oo
        total = of_level + of_other + std**2
        off = value - level - other
        likelihood = likelihood - 0.5 * (np.log(2.0 * math.pi * total) + off**2 / total)
        level, other = level + of_level / total * off, other + of_other / total * off
        ll, lo, oo = ll - of_level**2 / total, lo - of_level * of_other / total, oo - of_other**2 / total
    return _Walks(likelihood, level, ll)


def _walk(series: Series, found: _Walks, shared: Floats) -> Walk:
    each = found.likelihood + np.log(shared)
    top = float(each.max())
    averaged = top + np.log(np.exp(each - top).sum(axis=1))
    best = int(np.argmax(averaged))
    ratio = 2.0 * float(averaged[best] - averaged[0])
    weight = np.exp(each[best] - each[best].max())
    weight /= weight.sum()
    level = float(weight @ found.level[best])
    return Walk(
        rate=float(_RATES[best]) * series.unit / float(np.mean(np.diff(series.metres))),
        level=level,
        level_std=math.sqrt(float(weight @ (found.variance[best] + (found.level[best] - level) ** 2))),
        chance=0.5 * math.erfc(math.sqrt(0.5 * ratio)) if ratio > 0.0 else 1.0,
    )
