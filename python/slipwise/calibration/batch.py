# SPDX-License-Identifier: Apache-2.0
"""The off-line reference: one maximum-a-posteriori fit over all windows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.settings import Settings

Floats = NDArray[np.float64]


def fit_batch(
    motion: _core.MotionModel,
    windows: WindowSet,
    settings: Settings,
    noise: tuple[_core.MotionNoise, Floats],
    speeds: tuple[float, float],
) -> Belief:
    """Fit all windows at once by Levenberg-Marquardt with a Huber loss.

    Args:
        motion: the model whose parameters are fitted.
        windows: what to fit; nothing is held out.
        settings: priors and Huber threshold.
        noise: shape of the noise, and its factor of the variances of (x, y, yaw), [3].
        speeds: reference speed [m/s] and yaw rate [rad/s] of the priors.
    """
    shape, scale = noise
    table = settings.filter_settings()
    prior = _core.prior_estimate(motion, *speeds, table.prior)
    root = np.sqrt(scale)
    covariances = []
    for i, segment in enumerate(windows.segments):
        path = _core.integrate_segment(motion, prior.mean, windows.track(i), segment, _core.Integrator.Exact)
        expected = _core.slip_covariance(path, shape) + _core.pose_noise_covariance(segment.measured, shape)
        covariances.append(expected * np.outer(root, root))
    fit_settings = _core.BatchSettings()
    fit_settings.huber = settings.filter.huber
    tracks = [windows.track(i) for i in range(len(windows))]
    fit = _core.batch_fit(motion, prior, tracks, list(windows.segments), covariances, fit_settings)
    prior_std = np.sqrt(np.diag(prior.covariance))
    ratio = np.diag(fit.estimate.covariance) / prior_std**2 if len(prior_std) else np.zeros(0)
    return Belief(
        motion,
        np.array(fit.estimate.mean),
        np.array(fit.estimate.covariance),
        np.array(scale),
        prior_std,
        ratio,
        np.ones(1),
    )
