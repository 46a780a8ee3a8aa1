# SPDX-License-Identifier: Apache-2.0
"""Satellite fixes: WGS-84 to a local tangent plane, and headings from an IMU or from the path."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise.logs.log import Bools, Floats, Inputs
from slipwise.logs.streams import RawStream

_A = 6378137.0  # [m] WGS-84 semi-major axis
_F = 1.0 / 298.257223563  # WGS-84 flattening
_E2 = _F * (2.0 - _F)  # first eccentricity squared
_MAX_IMU_AGE = 0.5  # [s] an IMU sample further away says nothing about a fix
_HALF_CHORD = 0.25  # [m] of path on either side of a fix make its course
_MIN_CHORD = 0.2  # [m] a shorter piece of path has no course
_MAX_CHORD_TIME = 3.0  # [s] a piece of path that takes longer is not one course


def ecef(latitude: Floats, longitude: Floats, altitude: Floats) -> Floats:
    """Return earth-centred positions [N, 3] in m of fixes [N] in degrees and metres above the ellipsoid."""
    phi, lam = np.radians(latitude), np.radians(longitude)
    normal = _A / np.sqrt(1.0 - _E2 * np.sin(phi) ** 2)
    x = (normal + altitude) * np.cos(phi) * np.cos(lam)
    y = (normal + altitude) * np.cos(phi) * np.sin(lam)
    z = (normal * (1.0 - _E2) + altitude) * np.sin(phi)
    return np.stack([x, y, z], axis=-1)


def east_north_up(latitude: Floats, longitude: Floats, altitude: Floats) -> Floats:
    """Return positions [N, 3] in m (x east, y north, z up) in the tangent plane at the first fix."""
    first = (latitude[:1], longitude[:1], altitude[:1])
    return in_tangent_plane(ecef(latitude, longitude, altitude), *first)


def in_tangent_plane(points: Floats, latitude: Floats, longitude: Floats, altitude: Floats) -> Floats:
    """Return earth-centred points [N, 3] in m as east, north, up of a fix [1] in degrees and metres."""
    phi, lam = np.radians(latitude[0]), np.radians(longitude[0])
    east = np.array([-np.sin(lam), np.cos(lam), 0.0])
    north = np.array([-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)])
    up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
    origin = ecef(latitude, longitude, altitude)[0]
    return np.asarray((points - origin) @ np.stack([east, north, up], axis=1))


def angles_at(t: Floats, imu_t: Floats, angles: Floats) -> tuple[Floats, Bools]:
    """Interpolate an IMU's angles [M], such as its yaw, at the fixes.

    Returns:
        the angles [N] in rad, and whether there was an IMU sample near enough [N].
    """
    if len(imu_t) == 0:
        return np.full(len(t), np.nan), np.zeros(len(t), bool)
    found = np.interp(t, imu_t, np.unwrap(angles))
    return np.arctan2(np.sin(found), np.cos(found)), _near(t, imu_t)


def tilt_from_imu(t: Floats, imu_t: Floats, angle: Floats) -> Floats:
    """Interpolate the IMU's roll or pitch [M] at the fixes, [N]; NaN where no sample was near enough."""
    return np.where(_near(t, imu_t), np.interp(t, imu_t, angle), np.nan)


def _near(t: Floats, imu_t: Floats) -> Bools:
    """Whether the IMU spoke near enough to each time, [N]."""
    after = np.clip(np.searchsorted(imu_t, t), 0, len(imu_t) - 1)
    before = np.maximum(after - 1, 0)
    return np.asarray(np.minimum(np.abs(imu_t[after] - t), np.abs(imu_t[before] - t)) <= _MAX_IMU_AGE)


def course_of_path(t: Floats, x: Floats, y: Floats, inputs: Inputs | None) -> Floats:
    """Return a heading for each position [N]: that of the path, held and turned evenly where there is none.

    It serves pictures and checks of a log; what learns takes courses of its own (derivations/sensors.md).
    """
    yaw, known = heading_from_path(t, x, y, inputs)
    if not known.any():
        return np.zeros(len(t))
    every = np.interp(t, t[known], np.unwrap(yaw[known]))
    return np.asarray(np.arctan2(np.sin(every), np.cos(every)))


def with_course(stream: RawStream, inputs: Inputs | None) -> RawStream:
    """Return clean positions with the direction of their path as their yaw."""
    yaw = course_of_path(stream.t, stream.columns["x"], stream.columns["y"], inputs)
    return replace(stream, columns={**stream.columns, "yaw": yaw}, course=True)


def heading_from_path(t: Floats, x: Floats, y: Floats, inputs: Inputs | None) -> tuple[Floats, Bools]:
    """Take the direction of the path around each fix as heading, turned about when driving backward.

    Args:
        t: stamps [N] in s, increasing.
        x: positions [N] in m.
        y: positions [N] in m.
        inputs: say whether the robot drove backward; without them it is taken to drive forward.

    Returns:
        yaw [N] in rad, and whether the robot moved enough to have a course [N].
    """
    if len(t) == 0:
        return np.zeros(0), np.zeros(0, bool)
    path = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    i = np.maximum(np.searchsorted(path, path - _HALF_CHORD, side="right") - 1, 0)
    j = np.minimum(np.searchsorted(path, path + _HALF_CHORD), len(path) - 1)
    dx, dy = x[j] - x[i], y[j] - y[i]
    moved = (np.hypot(dx, dy) >= _MIN_CHORD) & (t[j] - t[i] <= _MAX_CHORD_TIME)
    yaw = np.arctan2(dy, dx)
    if inputs is not None:
        held = inputs.v[np.clip(np.searchsorted(inputs.t, t, side="right") - 1, 0, None)]
        yaw = np.where(held < 0.0, np.arctan2(-dy, -dx), yaw)
        moved &= held != 0.0
    return yaw, np.asarray(moved)
