# SPDX-License-Identifier: Apache-2.0
"""Quaternions of messages: checked, normalised, turned into angles, chained; rows are (x, y, z, w)."""

from __future__ import annotations

import numpy as np

from slipwise.logs.log import Bools, Floats

NORM_TOLERANCE = 1e-2


def unit_quaternions(q: Floats) -> tuple[Floats, Bools]:
    """Normalise quaternions [N, 4].

    Returns:
        The unit quaternions [N, 4], and whether each [N] was one to within 1e-2; the others are no rotation.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # a damaged message can hold anything
        norm = np.linalg.norm(q, axis=1)
    good = np.abs(norm - 1.0) <= NORM_TOLERANCE
    unit = np.tile([0.0, 0.0, 0.0, 1.0], (len(q), 1))
    unit[good] = q[good] / norm[good, None]
    return unit, np.asarray(good)


def angles_of(q: Floats) -> tuple[Floats, Floats, Floats]:
    """Return (roll, pitch, yaw) [N] in rad of unit quaternions [N, 4]: about fixed x, then y, then z."""
    x, y, z, w = q.T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return roll, pitch, yaw


def quaternions_of(roll: Floats, pitch: Floats, yaw: Floats) -> Floats:
    """Return the unit quaternions [N, 4] of angles [N] in rad; undoes `angles_of`."""
    cr, sr = np.cos(roll / 2), np.sin(roll / 2)
    cp, sp = np.cos(pitch / 2), np.sin(pitch / 2)
    cy, sy = np.cos(yaw / 2), np.sin(yaw / 2)
    parts = (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    return np.stack(parts, axis=1)


def product(a: Floats, b: Floats) -> Floats:
    """Return the quaternions [N, 4] of the rotation b followed by a."""
    av, aw, bv, bw = a[:, :3], a[:, 3:], b[:, :3], b[:, 3:]
    vector = aw * bv + bw * av + np.cross(av, bv)
    scalar = aw * bw - np.sum(av * bv, axis=1, keepdims=True)
    return np.concatenate([vector, scalar], axis=1)


def rotate(q: Floats, p: Floats) -> Floats:
    """Rotate points [N, 3] by unit quaternions [N, 4]."""
    v, w = q[:, :3], q[:, 3:]
    twice = 2.0 * np.cross(v, p)
    return np.asarray(p + w * twice + np.cross(v, twice))
