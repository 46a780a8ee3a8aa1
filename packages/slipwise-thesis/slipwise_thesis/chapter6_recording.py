# SPDX-License-Identifier: Apache-2.0
"""An on-line estimator's whole course over a drive: its posterior and its error at every update."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.predictors import Predictor, predictions_of
from slipwise.calibration.prepared_run import Ints, WindowSet, collect_windows, prepare_run
from slipwise.logs import Log
from slipwise_thesis import _thesis
from slipwise_thesis.estimators import estimator_motion, fed_windows
from slipwise_thesis.panel import Floats

HORIZON = 5.0  # s, of Table 6.2
EXACT, THESIS = _thesis.SegmentJacobian.Exact, _thesis.SegmentJacobian.Thesis


@dataclass(frozen=True)
class Course:
    """Which estimator, with what."""

    estimator: str
    basis: str = "thesis-15"
    input_name: str = "wheel"
    jacobian: _thesis.SegmentJacobian = THESIS  # of `ekf-thesis`

    @property
    def settings(self) -> Settings:
        """Settings of learning."""
        return Settings(basis=self.basis)


@dataclass(frozen=True, eq=False)
class Recording:
    """Posteriors before the first of K updates and after each."""

    course: Course
    motion: _core.MotionModel
    windows: WindowSet  # that count as learned, disjoint
    fed: WindowSet  # that were learned: overlapping for the thesis's estimators
    t: Floats  # [K + 1] s
    mean: Floats  # [K + 1, P]
    covariance: Floats  # [K + 1, P, P]
    innovation: Floats  # [K, 3] measured minus predicted, before the update
    noise_scale: Floats  # [K + 1, 3]
    prior_std: Floats  # [K + 1, P]

    @property
    def std(self) -> Floats:
        """Standard deviations, [K + 1, P]."""
        return np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))

    def posterior(self, count: int) -> Posterior:
        """Return the posterior once `count` of the windows have passed."""
        k = int(self._passed[count - 1]) if count > 0 else 0
        covariance, prior_std = self.covariance[k], self.prior_std[k]
        ratio = np.diag(covariance) / prior_std**2
        return Posterior(
            self.motion, self.mean[k], covariance, self.noise_scale[k], prior_std, ratio, np.ones(1)
        )

    @cached_property
    def _passed(self) -> Ints:
        """How many of those fed had ended when each window did."""
        return self.fed.passed(self.windows)

    def predictions(self, targets: WindowSet, name: str) -> Predictions:
        """Predict windows causally, and once more after they were learned."""
        shape = self.course.settings.filter_settings().noise.shape
        predictor = Predictor(name, shape, self.posterior, self.motion.dynamics)
        return predictions_of(predictor, self.windows, targets)


def drive_windows(log: Log, course: Course, length: float | None = None) -> WindowSet:
    """Cut a log into disjoint windows: those to learn from, or of a length [s] to predict."""
    drive = prepare_run(log, course.input_name)
    if length is None:
        return learning_windows(drive, course.input_name, course.settings)
    return collect_windows(drive, length, course.settings.rules())


def record(log: Log, course: Course) -> Recording:
    """Learn a drive from nothing and keep every posterior."""
    motion = estimator_motion(course.estimator, course.settings, course.input_name)
    settings = _thesis.EstimatorSettings()
    settings.ekf_thesis = _with_jacobian(settings.ekf_thesis, course.jacobian)
    estimator = _thesis.FollowingEstimator(
        course.estimator, motion, course.settings.filter_settings(), settings
    )
    windows = drive_windows(log, course)
    fed = fed_windows(course.estimator, course.settings, windows)
    posteriors = [_now(estimator)]
    innovation = np.empty((len(fed), 3))
    for i in range(len(fed)):
        innovation[i] = estimator.learn(fed.input_history(i), fed.segments[i]).innovation
        posteriors.append(_now(estimator))
    columns = [np.array(column) for column in zip(*posteriors, strict=True)]
    t = np.concatenate((fed.start[:1], fed.end))
    return Recording(
        course, motion, windows, fed, t, columns[0], columns[1], innovation, columns[2], columns[3]
    )


def _now(estimator: _thesis.FollowingEstimator) -> tuple[Floats, Floats, Floats, Floats]:
    """Mean, covariance, noise scale and prior standard deviations."""
    estimate = estimator.estimate()
    known = (estimate.mean, estimate.covariance, estimator.noise_scale, estimator.prior_std)
    mean, covariance, scale, prior = (np.array(value) for value in known)
    return mean, covariance, scale, prior


def _with_jacobian(
    settings: _thesis.EkfThesisSettings, jacobian: _thesis.SegmentJacobian
) -> _thesis.EkfThesisSettings:
    settings.jacobian = jacobian
    return settings
