# SPDX-License-Identifier: Apache-2.0
"""Noise that lasts: what is wrong now is wrong for a while."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def lasting_noise(t: Floats, time_constant: float, random: np.random.Generator, size: int) -> Floats:
    """Return first-order Gauss-Markov processes [N, size] of standard deviation 1 at stamps [N] in s."""
    noise = random.standard_normal((len(t), size))
    kept = np.exp(-np.diff(t) / time_constant)
    noise[1:] *= np.sqrt(1.0 - kept**2)[:, None]
    for column in noise.T:
        last, *new = column.tolist()
        for k, (stays, drawn) in enumerate(zip(kept.tolist(), new, strict=True), 1):
            column[k] = last = stays * last + drawn
    return noise
