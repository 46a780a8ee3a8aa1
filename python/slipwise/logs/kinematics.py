# SPDX-License-Identifier: Apache-2.0
"""Body twists from wheel speeds and steering angles, for logs that hold only these."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Floats


def twist_from_wheels(
    left: Floats, right: Floats, *, wheel_radius: float, track: float
) -> tuple[Floats, Floats]:
    """Return (v [m/s], omega [rad/s]) of a differential drive from its wheel speeds [N] in rad/s."""
    return 0.5 * wheel_radius * (right + left), wheel_radius * (right - left) / track


def omega_from_steering(v: Floats, steer: Floats, *, wheelbase: float) -> Floats:
    """Return the yaw rate [rad/s] of a car from its speed [N] in m/s and steering angle [N] in rad."""
    return np.asarray(v * np.tan(steer) / wheelbase, dtype=np.float64)
