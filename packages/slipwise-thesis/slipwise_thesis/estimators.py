# SPDX-License-Identifier: Apache-2.0
"""An estimator chosen by name: what it learns, and the windows that it wants."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.calibration.prepared_run import WindowSet, collect_windows
from slipwise.calibration.settings import Settings
from slipwise_thesis import _thesis

ESTIMATOR_BASIS = "odd-even-10"  # where the settings leave the basis to the average
THESIS_WINDOW = 5.0  # s
THESIS_STRIDE = 0.05  # s: 20 updates per second


def estimator_basis(settings: Settings) -> str:
    """Return the basis that a single estimator learns: that of the settings, or odd-even-10 for `auto`."""
    return ESTIMATOR_BASIS if settings.basis == "auto" else settings.basis


def estimator_motion(
    name: str, settings: Settings, input_name: str, wheelbase: float | None = None
) -> _core.MotionModel:
    """Return the model that an estimator learns; those of the thesis have neither actuator nor offset.

    With a wheelbase [m] the robot is commanded to steer, and lags act on its steering.
    """
    chosen = settings.model_copy(update={"basis": estimator_basis(settings)})
    thesis = _thesis.learns_overlapping_segments(name)
    dynamics, offset = learned_parts(settings, input_name)
    motion = _core.MotionModel(chosen.bases()[0], dynamics and not thesis, offset and not thesis)
    motion = motion.with_extrinsics(settings.sensor_extrinsics.learn and not thesis)
    return motion.with_wheelbase(wheelbase or 0.0) if motion.dynamics else motion


def learned_parts(settings: Settings, input_name: str) -> tuple[bool, bool]:
    """Say whether lag and delay are learned, as from commands, and the clock offset, as from wheels."""
    dynamics = input_name == "command"
    return dynamics, settings.learn_clock_offset and not dynamics


def estimator_learner(name: str, motion: _core.MotionModel, settings: Settings) -> EstimatorLearner:
    """Return the estimator before any data.

    Raises:
        ValueError: there is no such estimator.
    """
    return EstimatorLearner(
        _thesis.FollowingEstimator(name, motion, settings.filter_settings(), _thesis.EstimatorSettings())
    )


def fed_windows(name: str, settings: Settings, windows: WindowSet) -> WindowSet:
    """Return the windows that an estimator learns while `windows` pass: the thesis's see overlapping ones."""
    if not _thesis.learns_overlapping_segments(name):
        return windows
    rules = replace(settings.rules(), whole_frames=True, stride=THESIS_STRIDE)
    return collect_windows(windows.drive, settings.segment.length or THESIS_WINDOW, rules)


class EstimatorLearner:
    """One estimator, whose prior follows the speeds and whose noise follows the residuals."""

    def __init__(self, estimator: _thesis.FollowingEstimator) -> None:
        """`estimator` has learned nothing yet."""
        self._estimator = estimator
        self._motion = estimator.model

    def learn(self, inputs: _core.InputHistory, segment: _core.Segment) -> _core.IekfUpdate:
        """Learn one window."""
        return self._estimator.learn(inputs, segment)

    def posterior(self) -> Posterior:
        """Return the posterior that learning goes on from."""
        return self._posterior(self._estimator.running())

    def fitted(self) -> Posterior:
        """Return the estimate: the posterior, or where the estimator fits all windows at once, that fit."""
        return self._posterior(self._estimator.estimate())

    def _posterior(self, estimate: _core.Estimate) -> Posterior:
        prior_std, covariance = np.array(self._estimator.prior_std), np.array(estimate.covariance)
        return Posterior(
            motion=self._motion,
            mean=np.array(estimate.mean),
            covariance=covariance,
            noise_scale=np.array(self._estimator.noise_scale),
            prior_std=prior_std,
            variance_ratio=np.diag(covariance) / prior_std**2,
            weights=np.ones(1),
        )
