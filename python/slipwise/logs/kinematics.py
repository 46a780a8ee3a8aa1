# SPDX-License-Identifier: Apache-2.0
"""Body twists from wheel speeds, curvatures and steering angles, for logs that hold only these."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.findings.finding import RefusedLogError
from slipwise.logs.findings.readings import SteeringInDegrees
from slipwise.logs.log import Floats


def twist_from_wheels(
    left: Floats, right: Floats, *, wheel_radius: float, wheel_separation: float
) -> tuple[Floats, Floats]:
    """Return (v [m/s], omega [rad/s]) of a differential drive from its wheel speeds [N] in rad/s."""
    twists = _core.DifferentialDrive(wheel_radius, wheel_separation).twists(left, right)
    return twists[:, 0], twists[:, 1]


def omega_from_curvature(v: Floats, curvature: Floats, *, speed_factor: float) -> Floats:
    """Return the yaw rate [rad/s] from speed [N] and curvature [N] in 1/m: kappa V (thesis 3.2).

    The speed is in m/s once it is multiplied by `speed_factor`.
    """
    return speed_factor * curvature * v


def twist_from_steering(
    v: Floats, steer: Floats, *, wheelbase: float, speed_factor: float
) -> tuple[Floats, Floats]:
    """Return (v, omega [rad/s]) of a car from its speed [N] and steering angle [N] in rad.

    The speed is in m/s once it is multiplied by `speed_factor`, and returned as it is given. Where the car
    stands with turned wheels, v is a nanometre a second, and omega over it says how far.

    Raises:
        RefusedLogError: the angles are in degrees.
    """
    found = SteeringInDegrees.by(steer)
    if found is not None:
        raise RefusedLogError(found)
    twists: Floats = _core.Ackermann(wheelbase).twists(v, steer)
    return np.ascontiguousarray(twists[:, 0]), np.ascontiguousarray(speed_factor * twists[:, 1])
