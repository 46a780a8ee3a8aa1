# SPDX-License-Identifier: Apache-2.0
"""Learning from commands in two parts: the chain from wheel speeds, and the slip from poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.drive import WindowSet, collect_windows
from slipwise.calibration.learner import Belief, make_learner
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.settings import WINDOW_SECONDS, Settings
from slipwise.calibration.wheel_drive import chain_runs, wheel_runs

CHAIN_WINDOW = 1.0  # s; wheel speeds tell a step's response from its start on
RECENT_WINDOWS = 200  # from which the chain behind newly found limits is learned


class CascadePass:
    """Wheel speeds are the output of the chain and the input of the slip: each is learned from much more.

    Once `count` windows of the commands have passed, all that wheels and poses said until then is learned.
    """

    def __init__(self, windows: WindowSet, settings: Settings) -> None:
        """`windows` are those of the commands; each of their runs has wheel speeds."""
        self._windows = windows
        rules = replace(settings.rules(), whole_frames=True)
        self._slip_windows = collect_windows(wheel_runs(windows.drive), WINDOW_SECONDS["wheel"], rules)
        self._chain_windows = collect_windows(chain_runs(windows.drive), CHAIN_WINDOW, rules)
        slip = make_learner(settings, "wheel").fresh()
        self._slip = CausalPass(slip, self._slip_windows, self._see)
        self._changes: list[_core.ChangeTest] = []
        self._settings = settings
        self._chain = _chain_estimator(settings)
        self._chain_learned = 0
        self._limited: LimitedDrive | None = None
        self._offset = slip.model.clock_offset
        self.motion = _core.MotionModel.with_response(slip.model.basis, self._offset)

    def belief(self, count: int, noise_scale: np.ndarray) -> Belief:
        """Return the belief once `count` windows of the commands have passed."""
        slip = self._slip.belief(self._passed(self._slip_windows, count))
        self._learn_chain(self._passed(self._chain_windows, count))
        return self._joined(slip, noise_scale)

    def restart_behind(self, limited: LimitedDrive) -> None:
        """Put limits in front of the chain, and learn it anew from the most recent of its windows."""
        self._limited, self._chain = limited, _chain_estimator(self._settings)
        until = self._chain_learned
        self._chain_learned = max(until - RECENT_WINDOWS, 0)
        self._learn_chain(until)

    def _learn_chain(self, until: int) -> None:
        windows = self._chain_windows
        for i in range(self._chain_learned, until):
            self._chain.learn(windows.track(i, self._limited), windows.segments[i])
        self._chain_learned = max(self._chain_learned, until)

    def change(self, i: int) -> _core.ChangeTest:
        """Return the strongest test for a change of ground while window i of the commands passed."""
        before, after = (self._passed(self._slip_windows, count) for count in (i, i + 1))
        tests = self._changes[before:after] or [_core.ChangeTest()]
        return max(tests, key=lambda test: (test.alarm, test.log_odds))

    def _see(self, _i: int, _update: _core.IekfUpdate, change: _core.ChangeTest, _belief: Belief) -> None:
        self._changes.append(change)

    def _passed(self, windows: WindowSet, count: int) -> int:
        """How many of `windows` had ended when the last of `count` windows of the commands did."""
        if count == 0 or len(windows) == 0:
            return 0
        last = slice(count - 1, count)
        return int(windows.count_until(self._windows.position[last], self._windows.end[last])[0])

    def _joined(self, slip: Belief, noise_scale: np.ndarray) -> Belief:
        """Put slip, chain and clock offset, which is learned with the slip, into one belief."""
        chain = self._chain.estimate()
        size, slips, chains = self.motion.size, self.motion.slip_size, len(chain.mean)
        with_slip = np.r_[0:slips, slips + chains : size]
        of_chain = np.arange(slips, slips + chains)
        mean, prior_std, ratio = np.empty(size), np.empty(size), np.empty(size)
        covariance = np.zeros((size, size))
        mean[with_slip], mean[of_chain] = slip.mean, chain.mean
        covariance[np.ix_(with_slip, with_slip)] = slip.covariance
        covariance[np.ix_(of_chain, of_chain)] = chain.covariance
        prior_std[with_slip], prior_std[of_chain] = slip.prior_std, self._chain.prior_std
        ratio[with_slip] = slip.variance_ratio
        ratio[of_chain] = np.diag(chain.covariance) / np.array(self._chain.prior_std) ** 2
        return Belief(
            mean, covariance, noise_scale, prior_std, ratio, slip.weights, self.motion, limited=self._limited
        )


def _chain_estimator(settings: Settings) -> _core.FollowingEstimator:
    motion = _core.MotionModel.with_response(_core.Basis("none", [], [], []), False)
    return _core.FollowingEstimator("iekf", motion, settings.filter_settings(), _core.EstimatorSettings())
