# SPDX-License-Identifier: Apache-2.0
"""Pools what several experts say into one calibrated probability, and judges whether a surface is unknown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]


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
        """Return P(unknown) [N] where known and unknown are equally likely a priori.

        Args:
            probability: [N, K] pooled.
            newness: [N] of the vibration's expert.
        """
        return np.asarray(self.in_core.unknown(probability, newness))

    @property
    def in_core(self) -> _core.ExpertPool:
        """The pool as the core evaluates it."""
        return _core.ExpertPool(self.vibration, self.current, self.offset, self.doubt, self.newness)


def pooled(pool: Pool, vibration: Floats, current: Floats) -> Floats:
    """Return the pooled probabilities [N, K]; an expert whose exponent is 0 may hold NaN."""
    return np.asarray(pool.in_core.pooled(vibration, current))


def doubt_of(probability: Floats) -> Floats:
    """Return the log odds against the most probable surface, [N]."""
    return np.asarray(_core.doubt_of(probability))


def rejection_at(rejections: tuple[Rejection, ...], share: float) -> Rejection:
    """Return the rejection that finds at least this share of unknown windows at the least cost."""
    enough = [entry for entry in rejections if entry.unknown >= share - 1e-9]
    if not enough:
        return max(rejections, key=lambda entry: entry.unknown)
    return min(enough, key=lambda entry: entry.unknown)
