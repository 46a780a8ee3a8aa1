# SPDX-License-Identifier: Apache-2.0
"""A pass over windows that learns only as far as it is asked to, and keeps no belief but the present one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief, Progress, belief_of
from slipwise.calibration.result import History

Observer = Callable[[int, _core.IekfUpdate, _core.ChangeTest, Belief], None]


class CausalPass:
    """Learns windows in order; memory does not grow with their number."""

    def __init__(
        self, average: _core.ModelAverage, windows: WindowSet, observer: Observer | None = None
    ) -> None:
        """`observer` gets each window's index, its update, its test for a change, and the belief after it."""
        self._average, self._windows, self._observer = average, windows, observer
        self._learned = 0
        self._belief: Belief | None = None

    def belief(self, count: int) -> Belief:
        """Return the belief after `count` windows.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        if count < self._learned:
            raise ValueError(f"the belief after {count} windows is gone: {self._learned} are learned")
        for i in range(self._learned, count):
            update = self._average.learn(self._windows.track(i), self._windows.segments[i])
            self._belief = None
            self._learned = i + 1
            if self._observer is not None:
                self._observer(i, update, self._average.change, self._now())
        return self._now()

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def _now(self) -> Belief:
        if self._belief is None:
            self._belief = belief_of(self._average)
        return self._belief


class HistoryRecorder:
    """An observer that keeps mean and standard deviation of every parameter after each window."""

    def __init__(
        self, model: _core.MotionModel, windows: WindowSet, bases: tuple[str, ...], progress: Progress | None
    ) -> None:
        count, names = len(windows), tuple(info.name for info in model.parameters)
        self._progress = progress
        self.history = History(
            run=np.array([windows.drive[p].index for p in windows.position], dtype=np.int64),
            t=windows.end,
            names=names,
            mean=np.zeros((count, len(names))),
            std=np.zeros((count, len(names))),
            nis=np.zeros(count),
            weight=np.zeros(count),
            bases=bases,
            basis_weight=np.zeros((count, len(bases))),
            change=np.zeros(count),
            alarm=np.zeros(count, dtype=np.bool_),
        )

    def __call__(self, i: int, update: _core.IekfUpdate, change: _core.ChangeTest, belief: Belief) -> None:
        """Write the row of window i."""
        self.record(i, update.nis, update.weight, belief)
        self.mark(i, change)

    def record(self, i: int, nis: float, weight: float, belief: Belief) -> None:
        """Write the row of window i: its NIS before it was learned, its weight, the belief after it."""
        rows = self.history
        rows.mean[i], rows.std[i] = belief.mean, np.sqrt(np.diag(belief.covariance))
        rows.nis[i], rows.weight[i], rows.basis_weight[i] = nis, weight, belief.weights
        if self._progress is not None and i % 50 == 0:
            self._progress((i + 1) / len(rows.t))

    def mark(self, i: int, change: _core.ChangeTest) -> None:
        """Write into the row of window i whether the ground changed."""
        self.history.change[i], self.history.alarm[i] = change.log_odds, change.alarm
