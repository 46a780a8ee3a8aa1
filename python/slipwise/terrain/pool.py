# SPDX-License-Identifier: Apache-2.0
"""Pools what several experts say into one calibrated probability, and judges whether a surface is unknown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LEAST = 0.01  # of an expert's probability: nobody may rule a surface out alone


@dataclass(frozen=True)
class Rejection:
    """A bound on P(unknown), what it finds and what it costs; both as estimated in training."""

    unknown: float  # share of windows of surfaces left out of training that are called unknown
    known: float  # share of windows of known surfaces, in runs left out, that are called unknown too
    bound: float


@dataclass(frozen=True)
class Pool:
    """Exponents of the experts in a logarithmic pool, and the weights of the signs of an unknown surface."""

    vibration: float
    current: float
    offset: float
    doubt: float  # weight of the log odds against the most probable surface
    newness: float  # weight of the distance to what was trained
    rejections: tuple[Rejection, ...]

    def unknown(self, probability: Floats, newness: Floats) -> Floats:
        """Return P(unknown) [N] where known and unknown are equally likely beforehand.

        Args:
            probability: [N, K] pooled.
            newness: [N] of the vibration's expert.
        """
        score = self.offset + self.doubt * doubt_of(probability) + self.newness * newness
        return np.asarray(1.0 / (1.0 + np.exp(-np.clip(score, -50.0, 50.0))))


def pooled(pool: Pool, vibration: Floats, current: Floats) -> Floats:
    """Return the pooled probabilities [N, K]; an expert whose exponent is 0 may hold NaN."""
    logs = np.zeros(vibration.shape)
    for exponent, expert in ((pool.vibration, vibration), (pool.current, current)):
        if exponent != 0.0:
            logs = logs + exponent * np.log(expert + LEAST)
    raised = np.exp(logs - logs.max(axis=1, keepdims=True)) if len(logs) else logs
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


def doubt_of(probability: Floats) -> Floats:
    """Return the log odds against the most probable surface, [N]."""
    best = np.clip(probability.max(axis=1, initial=0.0), 1e-6, 1.0 - 1e-6)
    return np.asarray(np.log((1.0 - best) / best))


def rejection_at(rejections: tuple[Rejection, ...], share: float) -> Rejection:
    """Return the rejection that finds at least this share of unknown windows at the least cost."""
    enough = [entry for entry in rejections if entry.unknown >= share - 1e-9]
    if not enough:
        return max(rejections, key=lambda entry: entry.unknown)
    return min(enough, key=lambda entry: entry.unknown)
