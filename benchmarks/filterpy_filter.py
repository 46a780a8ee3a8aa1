# SPDX-License-Identifier: Apache-2.0
"""The same iterated filter made of filterpy's extended Kalman filter, with the measurement model in numpy."""

from __future__ import annotations

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter  # type: ignore[import-untyped]
from numpy_filter import Floats, Window, drive, jacobian_of


def make_filter(mean: Floats, covariance: Floats) -> ExtendedKalmanFilter:
    """Return filterpy's filter with the parameters as its state; they are constant, so it never predicts."""
    ekf = ExtendedKalmanFilter(dim_x=len(mean), dim_z=3)
    ekf.x, ekf.P = mean.copy(), covariance.copy()
    return ekf


def iekf_update(ekf: ExtendedKalmanFilter, window: Window, cov_z: Floats, iterations: int) -> None:
    """Update the filter with a window.

    Filterpy's update has one linearisation; iterating means updating the same prior again with the
    measurement model linearised at the last estimate. The covariance is that of the last estimate, as in
    the core.
    """
    prior, covariance, now = ekf.x.copy(), ekf.P.copy(), ekf.x.copy()
    for iteration in range(iterations + 1):
        path = drive(window, now)
        J = jacobian_of(path, window)
        tangent = path.end - J @ now
        ekf.x, ekf.P = prior.copy(), covariance.copy()
        ekf.update(
            window.measured, lambda _, J=J: J, lambda x, J=J, tangent=tangent: tangent + J @ x, R=cov_z
        )
        if iteration < iterations:
            now = np.asarray(ekf.x).copy()
    ekf.x = now
