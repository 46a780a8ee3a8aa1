# SPDX-License-Identifier: Apache-2.0
"""A simulated drive on a hillside: gravity leans in its frame, and what was true is seen from above."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipwise.ground import Grade
from slipwise.simulation.land_tamer import GRAVITY
from slipwise.simulation.truth import Truth

Floats = NDArray[np.float64]


def axes_of(grade: Grade) -> Floats:
    """Return the axes [3, 3] of a plane, in columns: x looks along yaw 0, z is its normal."""
    _, roll, pitch = grade.under((0.0, 0.0, 0.0)).standings(np.zeros((1, 3)))[0].tolist()
    cr, sr, cp, sp = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch)
    return np.array([[cp, sp * sr, sp * cr], [0.0, cr, -sr], [-sp, cp * sr, cp * cr]])


def gravity_on(grade: Grade | None) -> tuple[float, float, float]:
    """Return gravity in the frame of the plane [m/s^2]."""
    if grade is None:
        return 0.0, 0.0, -GRAVITY
    x, y, z = (-GRAVITY * axes_of(grade)[2]).tolist()
    return x, y, z


def seen_from_above(truth: Truth, position: Floats, grade: Grade) -> Truth:
    """Return what was true on the plane, in a frame whose z axis is vertical.

    Speeds stay along the plane.

    Args:
        truth: in the frame of the plane.
        position: MuJoCo's positions there: x, y, z [m] and the quaternion (w, x, y, z), [M, 7 or more].
        grade: the plane.
    """
    axes = axes_of(grade)
    place = position[:, :3] @ axes.T
    turned = np.einsum("ij,njk->nik", axes, _rotations(position[:, 3:7]))
    return replace(
        truth,
        x=place[:, 0],
        y=place[:, 1],
        z=place[:, 2],
        yaw=np.unwrap(np.arctan2(turned[:, 1, 0], turned[:, 0, 0])),
        pitch=-np.arcsin(turned[:, 2, 0]),
        roll=np.arctan2(turned[:, 2, 1], turned[:, 2, 2]),
    )


def _rotations(q: Floats) -> Floats:
    """Rotation matrices [M, 3, 3] of unit quaternions (w, x, y, z) [M, 4]."""
    w, x, y, z = q.T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), 2, 0)
