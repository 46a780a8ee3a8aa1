# SPDX-License-Identifier: Apache-2.0
"""Describes motor currents by their size, spread and ratio to wheel speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
_AMPERES, _RIPPLE, _SPEED = 0.3, 0.1, 0.05  # A, A, m/s: what is added below a logarithm, the sensors' steps


def current_features(values: Floats) -> Floats:
    """Return the features in the order of `CURRENT_FEATURES`.

    How fast and how unsteadily the robot is driven is left out: it tells one day's driver from another's,
    not one surface from another.

    Args:
        values: [n, 4] left and right current [A], left and right wheel speed [m/s], evenly sampled.
    """
    left, right = np.abs(values[:, 0]), np.abs(values[:, 1])
    speed_left, speed_right = np.abs(values[:, 2]).mean(), np.abs(values[:, 3]).mean()
    total = left + right
    features = []
    for current in (left, right):
        features += [_log(current.mean()), _log(current.std(), _RIPPLE), current.min(), _log(current.max())]
    features += [
        _log(total.mean()),
        _log(total.std(), _RIPPLE),
        _log(np.diff(total).std(), _RIPPLE),
        _log(left.mean()) - _log(right.mean()),
        _log(total.mean()) - _log(speed_left + speed_right, _SPEED),
        _log(left.mean()) - _log(speed_left, _SPEED),
        _log(right.mean()) - _log(speed_right, _SPEED),
        _correlation(left, right),
    ]
    return np.array(features, dtype=np.float64)


def _log(value: float, least: float = _AMPERES) -> float:
    return float(np.log(value + least))


def _correlation(left: Floats, right: Floats) -> float:
    spread = left.std() * right.std()
    if spread < 1e-9:
        return 0.0
    return float(((left - left.mean()) * (right - right.mean())).mean() / spread)
