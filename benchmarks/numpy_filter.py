# SPDX-License-Identifier: Apache-2.0
"""The causal filter in plain numpy, to compare speed with: exact steps, exact Jacobian, IEKF in Joseph form.

Vectorised over the steps of a window: headings are a cumulative sum, and the derivative of the last pose is
a sum over steps. It computes what `_core.iekf_update` computes, for the basis odd-even-10 without lag, delay
and offset. `cov_z` is the covariance of a window's measured pose, [3, 3].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LON, LAT, ANG = slice(0, 3), slice(3, 6), slice(6, 10)
SMALL_TURN = 0.1  # rad; below it the arc functions are Taylor series
TURN_RADIUS, STRAIGHT_RADIUS = (
    0.3,
    5.0,
)  # m: how turning counts as motion, and driving as turning (the core's)


@dataclass(frozen=True, eq=False)
class Window:
    """The inputs of one window, one entry per step, and the pose measured at its end."""

    v: Floats  # [N] m/s
    omega: Floats  # [N] rad/s
    duration: Floats  # [N] s
    measured: Floats  # [3] x, y [m], yaw [rad] seen from the start


@dataclass(frozen=True)
class Noise:
    """Slip noise per motion, slip that is a constant fraction of it, and pose noise."""

    psd_motion: Floats  # [3]
    fraction: Floats  # [3]
    pose_std_xy: float  # m
    pose_std_yaw: float  # rad


@dataclass(frozen=True, eq=False)
class Path:
    """A window driven with some parameters."""

    end: Floats  # [3] last pose
    by_tangent: Floats  # [N, 3, 3] derivative of the last pose by each step's tangent
    features: Floats  # [N, 10]


def features_of(v: Floats, omega: Floats) -> Floats:
    """Return the terms of odd-even-10 at every step, [N, 10]."""
    a, vw, ww = np.abs(omega), v * omega, omega * np.abs(omega)
    return np.column_stack((v, v * a, np.sign(v) * omega**2, omega, vw, ww, omega, vw, ww, v))


def arc_functions(f: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return sin(f)/f, (1 - cos f)/f and their derivatives by f."""
    small = np.abs(f) < SMALL_TURN
    g = np.where(small, 1.0, f)
    s, one_minus_c = np.sin(g), 2.0 * np.sin(g / 2.0) ** 2
    a, b = s / g, one_minus_c / g
    da, db = (1.0 - one_minus_c - a) / g, (s - b) / g
    q = f * f
    a = np.where(small, 1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72))), a)
    b = np.where(small, f / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56))), b)
    da = np.where(small, -f / 3 * (1 - q / 10 * (1 - q / 28 * (1 - q / 54))), da)
    db = np.where(small, 0.5 - q / 8 * (1 - q / 18 * (1 - q / 40 * (1 - q / 70))), db)
    return a, b, da, db


def drive(window: Window, alpha: Floats) -> Path:
    """Drive the window's steps exactly (method: constant twist per step) and keep what derivatives need."""
    features = features_of(window.v, window.omega)
    dt = window.duration
    forward = (window.v + features[:, LON] @ alpha[LON]) * dt
    left = (features[:, LAT] @ alpha[LAT]) * dt
    turn = (window.omega + features[:, ANG] @ alpha[ANG]) * dt
    a, b, da, db = arc_functions(turn)
    heading = np.concatenate(([0.0], np.cumsum(turn)))
    c, s = np.cos(heading[:-1]), np.sin(heading[:-1])
    dx, dy = a * forward - b * left, b * forward + a * left
    x, y = np.cumsum(c * dx - s * dy), np.cumsum(s * dx + c * dy)
    end = np.array([x[-1], y[-1], heading[-1]])
    dx_turn, dy_turn = da * forward - db * left, db * forward + da * left
    by_tangent = np.zeros((len(dt), 3, 3))
    by_tangent[:, 0, 0], by_tangent[:, 0, 1] = c * a - s * b, -c * b - s * a
    by_tangent[:, 1, 0], by_tangent[:, 1, 1] = s * a + c * b, -s * b + c * a
    by_tangent[:, 0, 2] = c * dx_turn - s * dy_turn - (end[1] - y)
    by_tangent[:, 1, 2] = s * dx_turn + c * dy_turn + (end[0] - x)
    by_tangent[:, 2, 2] = 1.0
    return Path(end, by_tangent, features)


def jacobian_of(path: Path, window: Window) -> Floats:
    """Return the derivative of the last pose by the parameters, [3, 10]."""
    weighted = path.by_tangent * window.duration[:, None, None]
    return np.hstack([weighted[:, :, i].T @ path.features[:, part] for i, part in enumerate((LON, LAT, ANG))])


def slip_covariance(path: Path, window: Window, noise: Noise) -> Floats:
    """Return the covariance of the last pose from slip noise, [3, 3]."""
    distance, turn = np.abs(window.v) * window.duration, np.abs(window.omega) * window.duration
    wheels = distance + TURN_RADIUS * turn
    motion = np.column_stack((wheels, wheels, turn + distance / STRAIGHT_RADIUS))
    white = path.by_tangent * np.sqrt(noise.psd_motion * motion)[:, None, :]
    constant = np.einsum("nij,nj->ij", path.by_tangent, noise.fraction * motion)
    flat = white.transpose(1, 0, 2).reshape(3, -1)
    return np.asarray(flat @ flat.T + constant @ constant.T)


def pose_covariance(measured: Floats, noise: Noise) -> Floats:
    """Return the covariance of a measured relative pose from the noise of both poses, [3, 3]."""
    from_start = -np.eye(3)
    from_start[0, 2], from_start[1, 2] = measured[1], -measured[0]
    pose = np.diag([noise.pose_std_xy**2, noise.pose_std_xy**2, noise.pose_std_yaw**2])
    return np.asarray(from_start @ pose @ from_start.T + pose)


def window_noise(window: Window, mean: Floats, noise: Noise) -> Floats:
    """Return the covariance of the window's measured pose given the parameters, [3, 3]."""
    return slip_covariance(drive(window, mean), window, noise) + pose_covariance(window.measured, noise)


def iekf_update(
    mean: Floats, P: Floats, window: Window, cov_z: Floats, iterations: int
) -> tuple[Floats, Floats]:
    """Return mean and covariance after a window: Gauss-Newton iterations, step-halving, Joseph form."""
    information = np.linalg.inv(cov_z)
    dual, now = np.zeros(len(mean)), mean
    J, r = _linearised(window, now)
    cost = r @ information @ r
    for _ in range(iterations):
        cov_r = J @ P @ J.T + cov_z
        step = J.T @ np.linalg.solve(cov_r, r - J @ (mean - now)) - dual
        for halving in range(5):
            trial = dual + step / 2.0**halving
            away = P @ trial
            at_trial, r_trial = _linearised(window, mean + away)
            cost_trial = trial @ away + r_trial @ information @ r_trial
            if cost_trial <= cost * (1.0 + 1e-12) + 1e-9:
                break
        else:
            break
        dual, now, J, r, cost = trial, mean + away, at_trial, r_trial, cost_trial
    K = np.linalg.solve(J @ P @ J.T + cov_z, J @ P).T
    keep = np.eye(len(mean)) - K @ J
    posterior = keep @ P @ keep.T + K @ cov_z @ K.T
    return now, (posterior + posterior.T) / 2.0


def _linearised(window: Window, mean: Floats) -> tuple[Floats, Floats]:
    """Return the Jacobian at `mean` and the measured minus the predicted pose."""
    path = drive(window, mean)
    return jacobian_of(path, window), window.measured - path.end
