# SPDX-License-Identifier: Apache-2.0
"""Describes an IMU's vibration by the logarithm of its power in bands of frequency, axis by axis."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from slipwise.terrain.recordings import IMU

Floats = NDArray[np.float64]

#: Hz. Below 0.5 Hz lies how the robot is driven and how steep it is there, not what it drives on.
EDGES = (0.5, 2.0, 4.0, 6.0, 8.0, 11.0, 14.0, 18.0, 23.0, 29.0, 36.0, 43.0, 50.0)
SEGMENT = 1.0  # s, of one periodogram; half of each overlaps the next (Welch)
FLOOR = 1e-9  # of power, so that a silent axis has a logarithm


def vibration_names(rate: float) -> list[str]:
    """Return the names of the features at a sampling rate [Hz]; none where there is no IMU."""
    return [f"{axis}_{low:g}_{high:g}_hz" for axis in IMU for low, high in _bands(rate)]


def vibration_features(values: Floats, rate: float) -> Floats:
    """Return the log power of each axis in each band, axis by axis.

    Args:
        values: [n, 6] rates [rad/s] and accelerations [m/s^2], evenly sampled for at least a second.
        rate: samples per second [Hz].
    """
    length = round(SEGMENT * rate)
    window = np.hanning(length)[:, None]
    centred = values - values.mean(axis=0)
    starts = range(0, max(len(values) - length, 0) + 1, length // 2)
    spectra = [np.abs(np.fft.rfft(centred[at : at + length] * window, axis=0)) ** 2 for at in starts]
    power = np.mean(spectra, axis=0) / (window**2).sum()
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    bands = [power[(frequency >= low) & (frequency < high)].mean(axis=0) for low, high in _bands(rate)]
    return np.asarray(np.log(np.stack(bands, axis=1) + FLOOR)).ravel()


def _bands(rate: float) -> list[tuple[float, float]]:
    edges = [edge for edge in EDGES if edge <= rate / 2 * 1.01]
    return list(pairwise(edges))
