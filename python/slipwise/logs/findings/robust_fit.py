# SPDX-License-Identifier: Apache-2.0
"""A linear fit that few windows which go astray do not bend."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats

_HUBER, _ROUNDS = 1.5, 6  # standard deviations beyond which a window counts less; rounds
_MEDIAN = 1.4826  # standard deviations in a median of absolute values


def robust_fit(inputs: Floats, values: Floats) -> tuple[Floats, Floats, float]:
    """Fit by Huber's weights (Ann. Math. Stat. 1964).

    Args:
        inputs: [N, K].
        values: [N] that gains of the inputs give.

    Returns:
        The gains [K], the weights [N] they came of, and the usual size of what is left.
    """
    weight, usual = np.ones(len(values)), 0.0
    gains = np.zeros(inputs.shape[1])
    for _ in range(_ROUNDS):
        root = np.sqrt(weight)
        gains = np.asarray(np.linalg.lstsq(inputs * root[:, None], values * root, rcond=None)[0])
        off = np.abs(values - inputs @ gains)
        usual = _MEDIAN * float(np.median(off)) + 1e-6
        weight = 1.0 / np.maximum(1.0, off / (_HUBER * usual))
    return gains, weight, usual
