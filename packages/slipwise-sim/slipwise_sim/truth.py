# SPDX-License-Identifier: Apache-2.0
"""What the simulated robot really did."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Truth:
    """Noiseless states at the pose rate, each of shape [M]; the robot's origin is amid its wheels."""

    t: NDArray[np.float64]  # [s]
    x: NDArray[np.float64]  # [m] in the world
    y: NDArray[np.float64]  # [m] in the world
    yaw: NDArray[np.float64]  # [rad] continuous, not wrapped
    vx: NDArray[np.float64]  # [m/s] forward, in the robot's frame
    vy: NDArray[np.float64]  # [m/s] leftward, in the robot's frame
    omega: NDArray[np.float64]  # [rad/s]
    wheel_left: NDArray[np.float64]  # [rad/s] mean of the left wheels
    wheel_right: NDArray[np.float64]  # [rad/s] mean of the right wheels
    z: NDArray[np.float64] | None = None  # [m] in the world; none on level ground
    roll: NDArray[np.float64] | None = None  # [rad]
    pitch: NDArray[np.float64] | None = None  # [rad], positive where the nose points down
