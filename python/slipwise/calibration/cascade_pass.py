# SPDX-License-Identifier: Apache-2.0
"""Learning from commands in two parts: the chain from wheel speeds, and the slip from poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.core_learners import AverageLearner, EstimatorLearner
from slipwise.calibration.drive import WindowSet, collect_windows
from slipwise.calibration.learner import CASCADE, Belief, make_learner
from slipwise.calibration.settings import WINDOW_SECONDS, Settings
from slipwise.calibration.wheel_drive import chain_runs, wheel_runs

CHAIN_WINDOW = 1.0  # s; wheel speeds tell a step's response from its start on


class CascadePass:
    """Wheel speeds are the output of the chain and the input of the slip: each is learned from much more.

    Once `count` windows of the commands have passed, all that wheels and poses said until then is learned.
    """

    def __init__(self, windows: WindowSet, settings: Settings) -> None:
        """`windows` are those of the commands; each of their runs has wheel speeds."""
        rules = replace(settings.rules(), whole_frames=True)
        slip_windows = collect_windows(wheel_runs(windows.drive), WINDOW_SECONDS["wheel"], rules)
        chain_windows = collect_windows(chain_runs(windows.drive), CHAIN_WINDOW, rules)
        average = make_learner(settings, "wheel").fresh()
        self._average = AverageLearner(average)
        self._slip = CausalPass(self._average, slip_windows, self._see, pace=windows)
        self._chain = CausalPass(EstimatorLearner(_chain_estimator(settings)), chain_windows, pace=windows)
        self._changes: list[_core.ChangeTest] = []
        self.motion = _core.MotionModel.with_response(average.model.basis, average.model.clock_offset)

    def belief(self, count: int, noise_scale: np.ndarray) -> Belief:
        """Return the belief once `count` windows of the commands have passed."""
        return self._joined(self._slip.belief(count), self._chain.belief(count), noise_scale)

    def change(self, i: int) -> _core.ChangeTest:
        """Return the strongest test for a change of ground while window i of the commands passed."""
        tests = self._changes[self._slip.passed(i) : self._slip.passed(i + 1)] or [_core.ChangeTest()]
        return max(tests, key=lambda test: (test.alarm, test.log_odds))

    def _see(self, _i: int, _update: _core.IekfUpdate, _belief: Belief) -> None:
        self._changes.append(self._average.change)

    def _joined(self, slip: Belief, chain: Belief, noise_scale: np.ndarray) -> Belief:
        """Put slip, chain and clock offset, which is learned with the slip, into one belief."""
        size, slips, chains = self.motion.size, self.motion.slip_size, len(chain.mean)
        with_slip = np.r_[0:slips, slips + chains : size]
        of_chain = np.arange(slips, slips + chains)
        mean, prior_std, ratio = np.empty(size), np.empty(size), np.empty(size)
        covariance = np.zeros((size, size))
        mean[with_slip], mean[of_chain] = slip.mean, chain.mean
        covariance[np.ix_(with_slip, with_slip)] = slip.covariance
        covariance[np.ix_(of_chain, of_chain)] = chain.covariance
        prior_std[with_slip], prior_std[of_chain] = slip.prior_std, chain.prior_std
        ratio[with_slip], ratio[of_chain] = slip.variance_ratio, chain.variance_ratio
        return Belief(
            self.motion, mean, covariance, noise_scale, prior_std, ratio, slip.weights, structure=CASCADE
        )


def _chain_estimator(settings: Settings) -> _core.FollowingEstimator:
    motion = _core.MotionModel.with_response(_core.Basis("none", [], [], []), False)
    return _core.FollowingEstimator("iekf", motion, settings.filter_settings(), _core.EstimatorSettings())
