# SPDX-License-Identifier: Apache-2.0
"""Body twists from wheel speeds, curvatures and steering angles, for logs that hold only these."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.log import Floats


def twist_from_wheels(
    left: Floats, right: Floats, *, wheel_radius: float, wheel_separation: float
) -> tuple[Floats, Floats]:
    """Return (v [m/s], omega [rad/s]) of a differential drive from its wheel speeds [N] in rad/s."""
    twists = _core.DifferentialDrive(wheel_radius, wheel_separation).twists(left, right)
    return twists[:, 0], twists[:, 1]


def omega_from_curvature(v: Floats, curvature: Floats) -> Floats:
    """Return the yaw rate [rad/s] from speed [N] in m/s and curvature [N] in 1/m: kappa V (thesis 3.2)."""
    return curvature * v


def twist_from_steering(v: Floats, steer: Floats, *, wheelbase: float) -> tuple[Floats, Floats]:
    """Return (v [m/s], omega [rad/s]) of a car from its speed [N] in m/s and steering angle [N] in rad.

    Where it stands with turned wheels, v is a nanometre a second, and omega over it says how far.
    """
    twists: Floats = _core.Ackermann(wheelbase).twists(v, steer)
    return np.ascontiguousarray(twists[:, 0]), np.ascontiguousarray(twists[:, 1])
