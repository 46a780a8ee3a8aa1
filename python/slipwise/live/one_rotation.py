# SPDX-License-Identifier: Apache-2.0
"""The rotation and the deviation of one pose: the numbers of a bag's reader, without arrays of one row."""

from __future__ import annotations

import math

import numpy as np

from slipwise.logs.log import ABSURD
from slipwise.logs.rotation import NORM_TOLERANCE


def rotation_of(x: float, y: float, z: float, w: float) -> tuple[float, float, float] | None:
    """Return (roll, pitch, yaw) [rad] of a quaternion; None where it is no rotation.

    To the last bit what `slipwise.logs.rotation` makes of many, so that a replay gives the bytes of
    `calibrate`: numpy's functions, for those of the C library may round otherwise.
    """
    try:
        norm = math.sqrt(x * x + y * y + z * z + w * w)
    except OverflowError:
        return None
    if not abs(norm - 1.0) <= NORM_TOLERANCE:
        return None
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    roll = float(np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))
    pitch = float(np.arcsin(min(max(2 * (w * y - z * x), -1.0), 1.0)))
    yaw = float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    return roll, pitch, yaw


def deviation(*variances: float) -> float | None:
    """Return the standard deviation of variances; None unless all are positive and can be."""
    if not all(0.0 < variance < ABSURD for variance in variances):  # false for NaN
        return None
    return math.sqrt(sum(variances) / len(variances))
