# SPDX-License-Identifier: Apache-2.0
"""Long curves are thinned before they are drawn, and the page says so."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CURVE_POINTS = 400  # of one curve over the page; more cannot be distinguished on a screen
SMALL_POINTS = 150  # of one curve in a small figure


def thinned(length: int, limit: int = CURVE_POINTS) -> NDArray[np.int64]:
    """Return the indices of at most `limit` evenly spaced entries, the first and the last among them."""
    if length <= limit:
        return np.arange(length, dtype=np.int64)
    return np.unique(np.linspace(0, length - 1, limit).round().astype(np.int64))


def thinning_note(length: int, limit: int = CURVE_POINTS) -> str:
    """Return the sentence that says how a curve was thinned, empty where it was not."""
    if length <= limit:
        return ""
    return f"Drawn thinned: {limit} evenly spaced of {length} points."
