# SPDX-License-Identifier: Apache-2.0
"""A terrain with the traction and rolling-resistance law of thesis (2.8) and (2.9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SMALLEST_SPEED = (
    1e-9  # [m/s] below it the direction of sliding does not matter: the force is zero to first order
)


@dataclass(frozen=True)
class TractionLaw:
    """Constants of the terrain, the same under every wheel; in brackets the thesis's names."""

    traction: float = 0.65  # [1] force over load of a fast sliding wheel (C1)
    traction_rate: float = 12.0  # [s/m] how soon sliding brings it about (A_t)
    traction_slope: float = 0.02  # [s/m] further force over load per sliding speed (C2)
    rolling: float = 0.04  # [1] drag over load of a fast wheel (R1)
    rolling_rate: float = 10.0  # [s/m] how soon rolling brings it about (A_roll)
    rolling_slope: float = 0.005  # [s/m] further drag over load per speed (R2)


def traction_force(
    law: TractionLaw,
    load: NDArray[np.float64],
    patch_velocity: NDArray[np.float64],
    rim_speed: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Force of the terrain on each wheel (Ward and Iagnemma 2008).

    (2.8) is a law of the forward sliding speed alone. Here the vector of sliding takes the place of the
    number, so that a wheel that slides sideways is held too; without sideways sliding it is (2.8) as printed.
    Both laws have continuous first derivatives: sign(v) (1 - exp(-A |v|)) passes zero with slope A.

    Args:
        law: the terrain.
        load: normal load [N], shape [wheels].
        patch_velocity: forward and leftward velocity of the contact patches, carried by the hubs without
            their spin [m/s], shape [2, wheels].
        rim_speed: spin times radius [m/s], shape [wheels].

    Returns:
        Forward and leftward force [N], shape [2, wheels].
    """
    forward = patch_velocity[0]
    sliding = -patch_velocity
    sliding[0] += rim_speed
    speed = np.hypot(sliding[0], sliding[1])
    gain = -np.expm1(-law.traction_rate * speed) * law.traction / np.maximum(speed, SMALLEST_SPEED)
    force: NDArray[np.float64] = sliding * (load * (gain + law.traction_slope))
    rolling = -np.expm1(-law.rolling_rate * np.abs(forward)) * law.rolling
    force[0] -= np.sign(forward) * load * (rolling + law.rolling_slope * np.abs(forward))
    return force
