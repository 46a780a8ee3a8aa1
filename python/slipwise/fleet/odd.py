# SPDX-License-Identifier: Apache-2.0
"""Robots unlike the others: judged by what their logs are good to and by how much the others differ."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

FEWEST_WEIGHTED = 5  # robots that show which of them is odd
FEWEST_OTHERS = 2  # that tell how much robots differ; with fewer nobody can tell which is odd
#: How much robots may differ beside what their logs are good to: every ratio is as likely by its logarithm.
RATIOS = 2.0 ** np.arange(-2.0, 10.0, 0.5)
#: For as many parameters counts that nothing is known of it; the others that a fleet has count one each.
GUESSED = 4.0
_ROUNDS = 20  # of expectation maximisation


@dataclass(frozen=True, eq=False)
class Estimates:
    """One parameter of each vehicle; NaN of those that have none."""

    estimate: Floats  # [V]
    std: Floats  # [V]
    weight: Floats  # [V] how much each counts for how much robots differ, as a Student t weighs them


@dataclass(frozen=True)
class Odd:
    """One vehicle and parameter against the other vehicles."""

    size: float  # off the others' mean
    std: float
    chance: float  # that one of this type is so far off
    likely: Floats  # how likely each of the `RATIOS` is,
    stds: Floats  # and the standard deviation of a new one then

    def least(self, chance: float) -> float:
        """Return the size from which on one of this type is so far off by a smaller chance alone."""
        low, high = 0.0, 100.0 * float(self.stds.max())
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _chance(middle / self.stds, self.likely) > chance else (low, middle)
        return high


@dataclass(frozen=True, eq=False)
class _Others:
    """What the others say of a new one, for each of the `RATIOS`."""

    evidence: Floats  # log likelihood of their differences
    off: Floats
    std: Floats  # of a new one's measured value


def odd_ones(parameters: Sequence[Estimates]) -> list[dict[int, Odd]]:
    """Compare each vehicle with all others in each parameter, by its place; none where too few have one.

    How much robots differ is hardly known from two or three of them. The other parameters of the same robots
    say how much they mostly do, in units of what the logs are good to.
    """
    vehicles = max((len(each.std) for each in parameters), default=0)
    found: list[dict[int, Odd]] = [{} for _ in parameters]
    for vehicle in range(vehicles):
        places = [k for k, each in enumerate(parameters) if _compared(each, vehicle)]
        others = [_others(parameters[k], vehicle) for k in places]
        for k, said, likely in zip(places, others, _likely([each.evidence for each in others]), strict=True):
            chance = _chance(np.abs(said.off) / said.std, likely)
            std = math.sqrt(float(likely @ said.std**2))
            found[k][vehicle] = Odd(float(likely @ said.off), std, chance, likely, said.std)
    return found


def _chance(z: Floats, likely: Floats) -> float:
    beyond = np.array([math.erfc(each / math.sqrt(2.0)) for each in z.tolist()])
    return min(float(likely @ beyond), 1.0)


def _compared(parameter: Estimates, vehicle: int) -> bool:
    known = np.isfinite(parameter.std)
    return bool(known[vehicle]) and int(known.sum()) > FEWEST_OTHERS


def _others(parameter: Estimates, vehicle: int) -> _Others:
    others = np.isfinite(parameter.std) & (np.arange(len(parameter.std)) != vehicle)
    value, variance = parameter.estimate[others], parameter.std[others] ** 2
    weight = parameter.weight[others] if len(value) >= FEWEST_WEIGHTED else np.ones(len(value))
    between = RATIOS[:, None] ** 2 * np.median(variance)
    whole = variance + between / weight  # [ratios, others]
    precision = 1.0 / whole
    total = precision.sum(axis=1)
    mean = (precision * value).sum(axis=1) / total
    squares = (precision * (value - mean[:, None]) ** 2).sum(axis=1)
    evidence = -0.5 * (np.log(whole).sum(axis=1) + np.log(total) + squares)
    std = np.sqrt(between[:, 0] + parameter.std[vehicle] ** 2 + 1.0 / total)
    return _Others(evidence, parameter.estimate[vehicle] - mean, std)


def _likely(evidence: Sequence[Floats]) -> list[Floats]:
    """Return how likely each ratio is in each parameter, by its own others and by the other parameters."""
    if not evidence:
        return []
    own = np.exp([each - each.max() for each in evidence])
    flat = np.full(len(RATIOS), 1.0 / len(RATIOS))
    posterior = own * flat
    for _ in range(_ROUNDS):
        posterior = posterior / posterior.sum(axis=1, keepdims=True)
        beside = posterior.sum(axis=0) - posterior  # without the parameter itself
        posterior = own * (GUESSED * flat + beside)
    return list(posterior / posterior.sum(axis=1, keepdims=True))
