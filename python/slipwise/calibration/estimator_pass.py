# SPDX-License-Identifier: Apache-2.0
"""A causal pass of one on-line estimator, chosen by name, fed with windows as that estimator wants them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import WindowSet, collect_windows
from slipwise.calibration.learner import Belief, make_learner
from slipwise.calibration.settings import Settings

ESTIMATOR_BASIS = "odd-even-10"  # where the settings leave the basis to the average
THESIS_WINDOW = 5.0  # s
THESIS_STRIDE = 0.05  # s: 20 updates per second


def estimator_basis(settings: Settings) -> str:
    """Return the basis that a single estimator learns: that of the settings, or odd-even-10 for `auto`."""
    return ESTIMATOR_BASIS if settings.basis == "auto" else settings.basis


def estimator_motion(name: str, settings: Settings, input_name: str) -> _core.MotionModel:
    """Return the model that an estimator learns; those of the thesis have no lag, delay, offset or mount."""
    chosen = settings.model_copy(update={"basis": estimator_basis(settings)})
    learner = make_learner(chosen, input_name)
    thesis = _core.learns_overlapping_segments(name)
    motion = _core.MotionModel(
        learner.bases[0], learner.dynamics and not thesis, learner.clock_offset and not thesis
    )
    return motion.with_mount(learner.mount and not thesis)


class EstimatorPass:
    """Learns in the order of time, as far as it is asked to."""

    def __init__(self, name: str, motion: _core.MotionModel, settings: Settings, windows: WindowSet) -> None:
        """`windows` count as learned; estimators of the thesis see overlapping ones until the same time.

        Raises:
            ValueError: there is no such estimator.
        """
        self._estimator = _core.FollowingEstimator(
            name, motion, settings.filter_settings(), settings.estimator_settings()
        )
        self._windows, self._fed = windows, windows
        if _core.learns_overlapping_segments(name):
            rules = replace(settings.rules(), whole_frames=True, stride=THESIS_STRIDE)
            length = settings.window.length or THESIS_WINDOW
            self._fed = collect_windows(windows.drive, length, rules)
        self._learned = 0

    def belief(self, count: int) -> Belief:
        """Return the belief once `count` windows have passed.

        Raises:
            ValueError: more than that is learned already, and nothing learned is ever unlearned.
        """
        until = self._fed_until(count)
        if until < self._learned:
            raise ValueError(f"the belief after {until} windows is gone: {self._learned} are learned")
        for i in range(self._learned, until):
            self._estimator.learn(self._fed.track(i), self._fed.segments[i])
        self._learned = until
        return self._now()

    def _fed_until(self, count: int) -> int:
        if count == 0 or self._fed is self._windows:
            return count
        last = slice(count - 1, count)
        return int(self._fed.count_until(self._windows.position[last], self._windows.end[last])[0])

    def _now(self) -> Belief:
        estimate, prior_std = self._estimator.estimate(), np.array(self._estimator.prior_std)
        covariance = np.array(estimate.covariance)
        return Belief(
            mean=np.array(estimate.mean),
            covariance=covariance,
            noise_scale=np.array(self._estimator.noise_scale),
            prior_std=prior_std,
            variance_ratio=np.diag(covariance) / prior_std**2,
            weights=np.ones(1),
        )
