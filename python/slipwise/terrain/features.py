# SPDX-License-Identifier: Apache-2.0
"""Describes vibration by its log power in bands of frequency, motor currents by size, spread and ratio."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.terrain.recordings import IMU

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


def vibration_names(rate: float) -> list[str]:
    """Return the names of the features at a sampling rate [Hz]; none where there is no IMU."""
    return [f"{axis}_{low:g}_{high:g}_hz" for axis in IMU for low, high in _bands(rate).edges]


def vibration_features(values: Floats, rate: float) -> Floats:
    """Return the log power of each axis in each band, axis by axis (Welch's method, segments of 1 s).

    Args:
        values: [n, 6] rates [rad/s] and accelerations [m/s^2], evenly sampled for at least a second.
        rate: samples per second [Hz].
    """
    return np.asarray(_bands(rate).features(values))


@lru_cache(maxsize=16)
def _bands(rate: float) -> _core.VibrationBands:
    return _core.VibrationBands(rate)


def current_features(values: Floats) -> Floats:
    """Return the features in the order of `CURRENT_FEATURES`.

    How fast and how unsteadily the robot is driven is left out: it tells one day's driver from another's,
    not one surface from another.

    Args:
        values: [n, 4] left and right current [A], left and right wheel speed [m/s], evenly sampled.
    """
    return np.asarray(_core.current_features(values))
