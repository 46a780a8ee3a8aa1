# SPDX-License-Identifier: Apache-2.0
"""A linear fit that few windows which go astray do not bend."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats

_HUBER, _ROUNDS = 1.5, 6  # standard deviations beyond which a window counts less; rounds
_MEDIAN = 1.4826  # standard deviations in a median of absolute values


def robust_fit(inputs: Floats, values: Floats) -> Floats:
    """Return gains [K] of inputs [N, K] that give values [N], by Huber's weights (Ann. Math. Stat. 1964)."""
    return weighted_fit(inputs, values)[0]


def weighted_fit(inputs: Floats, values: Floats) -> tuple[Floats, Floats, float]:
    """Return the gains [K], the weights [N] they came of, and the usual size of what is left."""
    weight, usual = np.ones(len(values)), 0.0
    gains = np.zeros(inputs.shape[1])
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)
        gains = np.asarray(np.linalg.lstsq(inputs * root[:, None], values * root, rcond=None)[0])
        off = np.abs(values - inputs @ gains)
        usual = _MEDIAN * float(np.median(off)) + 1e-6
        weight = 1.0 / np.maximum(1.0, off / (_HUBER * usual))
    return gains, weight, usual
