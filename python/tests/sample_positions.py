# SPDX-License-Identifier: Apache-2.0
"""What logs of positions in tests share: slip, an antenna off centre, and a drive with all that is hard."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.logs import Inputs

BASIS = _core.named_basis("full-linear-6")
SLIP = (-0.05, 0.02, 0.01, 0.15, -0.02, -0.3)  # side slip in turns, and a hundredth of the speed always
SECONDS = 240.0
ANTENNA = (0.3, 0.1, 0.0)
SETTINGS = make_settings({"basis": "full-linear-6", "sensor_extrinsics": {"x": 0.3, "y": 0.1}})
HORIZONS = (1.0, 2.0, 5.0)


def commands(random: np.random.Generator) -> Inputs:
    """Arcs, reverse, standstill and turns on the spot, each for 1.5 s."""
    count = int(SECONDS / 1.5)
    v, omega = random.uniform(0.4, 1.5, count), random.uniform(-0.8, 0.8, count)
    for k in range(0, count - 20, 20):
        v[k + 6 : k + 10] *= -1.0
        v[k + 14 : k + 16] = omega[k + 14 : k + 16] = 0.0
        v[k + 17], omega[k + 17] = 0.0, 0.7
    held_v, held_omega = np.repeat(v, 10), np.repeat(omega, 10)
    return Inputs(t=0.15 * np.arange(10 * count), v=held_v, vy=np.zeros(10 * count), omega=held_omega)
