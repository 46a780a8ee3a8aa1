# SPDX-License-Identifier: Apache-2.0
"""A simulated drive on a hillside: gravity leans in its frame, and what was true is seen from above."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipwise.ground import Grade
from slipwise.logs.log import Inputs
from slipwise.logs.rotation import angles_of, product, quaternions_of, rotate
from slipwise_sim.land_tamer import GRAVITY
from slipwise_sim.truth import Truth

Floats = NDArray[np.float64]

_PERIOD = 0.1  # s, of the commands of a drive
_LEGS, _TURNS = (4.0, 8.0), (1.5, 3.5)  # s


def axes_of(grade: Grade) -> Floats:
    """Return the axes [3, 3] of a plane, in columns: x looks along yaw 0, z is its normal."""
    return rotate(np.repeat(_tilt(grade), 3, axis=0), np.eye(3)).T


def _tilt(grade: Grade) -> Floats:
    """The rotation [1, 4] of a robot that stands on the plane and looks along yaw 0."""
    _, roll, pitch = grade.under((0.0, 0.0, 0.0)).standings(np.zeros((1, 3))).T
    return quaternions_of(roll, pitch, np.zeros(1))


def gravity_on(grade: Grade | None) -> tuple[float, float, float]:
    """Return gravity in the frame of the plane [m/s^2]."""
    if grade is None:
        return 0.0, 0.0, -GRAVITY
    x, y, z = (-GRAVITY * axes_of(grade)[2]).tolist()
    return x, y, z


def traverse_drive(seed: int, duration: float) -> Inputs:
    """Return a command script: straight legs of 4 s to 8 s, a turn of 1.5 s to 3.5 s after each."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, duration, _PERIOD)
    v, omega = np.zeros_like(t), np.zeros_like(t)
    row = 0
    while row < len(t):
        straight, turn = (int(random.uniform(*seconds) / _PERIOD) for seconds in (_LEGS, _TURNS))
        v[row : row + straight] = random.uniform(0.5, 1.6)
        row += straight
        v[row : row + turn] = random.uniform(0.2, 1.2)
        omega[row : row + turn] = random.choice((-1.0, 1.0)) * random.uniform(0.2, 0.6)
        row += turn
    return Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega)


def seen_from_above(truth: Truth, position: Floats, grade: Grade) -> Truth:
    """Return what was true on the plane, in a frame whose z axis is vertical.

    Speeds stay along the plane.

    Args:
        truth: in the frame of the plane.
        position: MuJoCo's positions there: x, y, z [m] and the quaternion (w, x, y, z), [M, 7 or more].
        grade: the plane.
    """
    tilt = np.repeat(_tilt(grade), len(position), axis=0)
    x, y, z = rotate(tilt, position[:, :3]).T
    roll, pitch, yaw = angles_of(product(tilt, position[:, [4, 5, 6, 3]]))
    return replace(truth, x=x, y=y, z=z, yaw=np.unwrap(yaw), pitch=pitch, roll=roll)
