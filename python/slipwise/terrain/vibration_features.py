# SPDX-License-Identifier: Apache-2.0
"""Describes an IMU's vibration by the logarithm of its power in bands of frequency, axis by axis."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.terrain.recordings import IMU

Floats = NDArray[np.float64]


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
