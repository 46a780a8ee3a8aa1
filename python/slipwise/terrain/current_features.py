# SPDX-License-Identifier: Apache-2.0
"""Describes motor currents by their size, spread and ratio to wheel speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

#: Natural logarithms, but for the least currents [A] and the correlation.
CURRENT_FEATURES = (
    "left_mean",
    "left_std",
    "left_least",
    "left_most",
    "right_mean",
    "right_std",
    "right_least",
    "right_most",
    "sum_mean",
    "sum_std",
    "sum_change",
    "left_over_right",
    "sum_over_speed",
    "left_over_speed",
    "right_over_speed",
    "left_right_correlation",
)


def current_features(values: Floats) -> Floats:
    """Return the features in the order of `CURRENT_FEATURES`.

    How fast and how unsteadily the robot is driven is left out: it tells one day's driver from another's,
    not one surface from another.

    Args:
        values: [n, 4] left and right current [A], left and right wheel speed [m/s], evenly sampled.
    """
    return np.asarray(_core.current_features(values))
