# SPDX-License-Identifier: Apache-2.0
"""The posterior of a model's parameters at one time, as verdicts, model files and reports take it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]
Progress = Callable[[float], None]

STRUCTURES = ("joint", "cascaded", "limits", "direct", "baseline")  # how motion is explained
JOINT, CASCADED, LIMITS, DIRECT, BASELINE = range(len(STRUCTURES))


@dataclass(frozen=True, eq=False)
class Posterior:
    """The posterior of a model's parameters at one time."""

    motion: _core.MotionModel  # whose parameters these are
    mean: Floats  # [P]
    covariance: Floats  # [P, P]
    noise_scale: Floats  # [3]
    prior_std: Floats  # [P]
    variance_ratio: Floats  # [P] posterior / prior variance
    weights: Floats  # [B]
    noise: _core.MotionNoise | None = None  # where the method learns its own; None: that of its predictor
    disturbance: _core.DisturbanceFilter | None = None  # of slip about this, where that is learned
    limits: _core.CommandLimits | None = None  # in front of the actuator, where some were found
    car: _core.CarCurves | None = None  # whose curves made the inputs, where they leave something open
    structure: int = JOINT  # of STRUCTURES; the errors of each are a population of their own

    def for_core(self, noise: _core.MotionNoise) -> _core.MotionPosterior:
        """Return it as the core takes it; `noise` is that model of the noise where it has none of its own."""
        estimate = _core.Estimate(self.mean, self.covariance)
        return _core.MotionPosterior(
            self.motion, estimate, self.prior_std, self.noise or noise, self.noise_scale
        )


def posterior_of(
    posterior: _core.MotionPosterior, disturbance: _core.DisturbanceFilter | None = None
) -> Posterior:
    """Return what the core knows."""
    return Posterior(
        motion=posterior.model,
        mean=np.array(posterior.estimate.mean),
        covariance=np.array(posterior.estimate.covariance),
        noise_scale=np.array(posterior.noise_scale),
        prior_std=np.array(posterior.prior_std),
        variance_ratio=np.array(posterior.variance_ratio),
        weights=np.array(posterior.basis_weights),
        disturbance=disturbance,
        structure=posterior.structure,
    )
