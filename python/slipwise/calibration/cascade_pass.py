# SPDX-License-Identifier: Apache-2.0
"""Learning from commands in two parts: the chain from wheel speeds, and the slip from poses."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.core_learners import AverageLearner, ChainLearner
from slipwise.calibration.drive import WindowSet, collect_windows
from slipwise.calibration.learner import CASCADE, LIMITS, Belief, make_learner
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.settings import WINDOW_SECONDS, Settings
from slipwise.calibration.wheel_drive import chain_runs, wheel_runs
from slipwise.segments import WindowRules

NO_SENSOR = WindowRules().sensor
CHAIN_WINDOW = 1.0  # s; wheel speeds tell a step's response from its start on
RECENT_CHAIN_WINDOWS = 200  # from which the chain behind newly found limits is learned
JUDGED, MISSES, MISS = 20, 6, 11.34  # of the last chain windows, so many beyond the 99 % point of chi2 of 3


class _WatchedChain(ChainLearner):
    """Counts how often wheel speeds leave what the chain foretells; nobody asks for beliefs on the way."""

    def __init__(self, learner: _core.ChainLearner) -> None:
        super().__init__(learner)
        self._missed: deque[bool] = deque(maxlen=JUDGED)

    def learn(self, inputs: _core.InputTrack, segment: _core.Segment) -> _core.ChainUpdate:
        """Learn one window."""
        update = super().learn(inputs, segment)
        self._missed.append(update.nis > MISS)
        return update

    @property
    def fails(self) -> bool:
        """Whether that was too often of late for the chain to be true."""
        return sum(self._missed) >= MISSES


class CascadePass:
    """Wheel speeds are the output of the chain and the input of the slip: each is learned from much more.

    Once `count` windows of the commands have passed, all that wheels and poses said until then is learned.
    """

    def __init__(self, windows: WindowSet, settings: Settings) -> None:
        """`windows` are those of the commands; each of their runs has wheel speeds."""
        rules = replace(settings.rules(), whole_frames=True)
        slip_windows = collect_windows(wheel_runs(windows.drive), WINDOW_SECONDS["wheel"], rules)
        at_wheels = replace(rules, sensor=NO_SENSOR)  # what wheels tell is the motion of base_link itself
        self._windows, self._settings = windows, settings
        self._chain_windows = collect_windows(chain_runs(windows.drive), CHAIN_WINDOW, at_wheels)
        average = make_learner(settings, "wheel").fresh()
        self._average = AverageLearner(average)
        self._slip = CausalPass(self._average, slip_windows, self._see, pace=windows)
        self._learn_chain(self._chain_windows)
        self._limited: LimitedDrive | None = None
        self.change = _core.ChangeTest()  # the strongest test for a change of ground since the last belief
        response = _core.MotionModel.with_response(average.model.basis, average.model.clock_offset)
        self.motion = response.with_mount(average.model.mount)
        slips, size = self.motion.slip_size, self.motion.size
        chain_end = slips + size - average.model.size
        self._of_chain = np.arange(slips, chain_end)
        self._of_slip = np.r_[0:slips, chain_end:size]  # clock offset and mount are learned with the slip

    def belief(self, count: int, noise_scale: np.ndarray) -> Belief:
        """Return the belief once `count` windows of the commands have passed."""
        self.change = _core.ChangeTest()
        return self._joined(self._slip.belief(count), self._chain.belief(count), noise_scale)

    def restart_behind(self, limited: LimitedDrive) -> None:
        """Put limits in front of the chain, and learn it anew from the last of its windows."""
        drive = self._chain_windows.drive
        runs = tuple(replace(run, track=limited.track(k)) for k, run in enumerate(drive))
        waiting = min(self._chain.learned, RECENT_CHAIN_WINDOWS)
        self._limited = limited
        self._learn_chain(replace(self._chain_windows, drive=runs), self._chain.learned - waiting, waiting)

    @property
    def chain_fails(self) -> bool:
        """Whether wheel speeds have left what the chain foretells too often of late for it to be true."""
        return self._watched.fails

    def _see(self, _i: int, _update: _core.IekfUpdate, _belief: Belief) -> None:
        self.change = max(self.change, self._average.change, key=lambda test: (test.alarm, test.log_odds))

    def _learn_chain(self, windows: WindowSet, first: int = 0, waiting: int = 0) -> None:
        """Begin anew with window `first`, `waiting` windows being known."""
        self._watched = _WatchedChain(_core.ChainLearner(self._settings.filter_settings(), waiting))
        self._chain = CausalPass(self._watched, windows, pace=self._windows, first=first)

    def _joined(self, slip: Belief, chain: Belief, noise_scale: np.ndarray) -> Belief:
        """Put slip and chain into one belief."""
        size = self.motion.size
        mean, prior_std, ratio = np.empty(size), np.empty(size), np.empty(size)
        covariance = np.zeros((size, size))
        for places, part in ((self._of_slip, slip), (self._of_chain, chain)):
            mean[places], prior_std[places], ratio[places] = part.mean, part.prior_std, part.variance_ratio
            covariance[places[:, None], places] = part.covariance
        belief = Belief(self.motion, mean, covariance, noise_scale, prior_std, ratio, slip.weights)
        structure = CASCADE if self._limited is None else LIMITS
        return replace(belief, limited=self._limited, structure=structure)
