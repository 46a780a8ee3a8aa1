# SPDX-License-Identifier: Apache-2.0
"""From commands: chain and slip learned together or in cascade, whichever predicts better."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.core_learners import AverageLearner
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.history_recorder import HistoryRecorder
from slipwise.calibration.learner import CASCADE, STRUCTURES, TOGETHER, Belief
from slipwise.calibration.settings import Settings
from slipwise.calibration.wheel_drive import has_wheels

Floats = NDArray[np.float64]
EQUAL = np.full(len(STRUCTURES), 1.0 / len(STRUCTURES))


def learning_pass(
    average: _core.ModelAverage,
    windows: WindowSet,
    settings: Settings,
    recorder: HistoryRecorder | None = None,
) -> CausalPass[_core.IekfUpdate] | StructureChoice:
    """Return the pass that learns `average`; `auto` also tries the cascade where wheel speeds allow it."""
    tries = settings.basis == "auto" and settings.auto.cascade
    if tries and average.model.dynamics and has_wheels(windows.drive):
        return StructureChoice(average, windows, settings, recorder)
    return average_pass(average, windows, recorder)


def average_pass(
    average: _core.ModelAverage, windows: WindowSet, recorder: HistoryRecorder | None = None
) -> CausalPass[_core.IekfUpdate]:
    """Return the pass that learns chain and slip together."""
    learner = AverageLearner(average)

    def see(i: int, update: _core.IekfUpdate, belief: Belief) -> None:
        if recorder is not None:
            recorder.record(i, update.nis, update.weight, belief)
            recorder.mark(i, learner.change, belief)

    return CausalPass(learner, windows, None if recorder is None else see)


class StructureChoice:
    """Runs both causally and weighs them by their predictive likelihood, as bases are weighed.

    Predictions are those of the heavier one: the two have different parameters, which have no mean.
    """

    def __init__(
        self,
        average: _core.ModelAverage,
        windows: WindowSet,
        settings: Settings,
        recorder: HistoryRecorder | None = None,
    ) -> None:
        """`recorder` keeps the beliefs of both, and their weights."""
        self._windows, self._weighing = windows, settings.average_settings().weighing
        self._average = AverageLearner(average)
        self._together = CausalPass(self._average, windows, self._see)
        self._cascade = CascadePass(windows, settings)
        self._score = _core.PredictiveScore(settings.filter_settings().noise)
        self._believed = self._cascade.belief(0, np.array(self._score.noise_scale))
        self._recorder = recorder
        self._weights = EQUAL
        self._learned = 0

    def belief(self, count: int) -> Belief:
        """Return the heavier belief after `count` windows.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        if count < self._learned:
            raise ValueError(f"the belief after {count} windows is gone: {self._learned} are learned")
        for i in range(self._learned, count):
            self._weigh(i)
        self._learned = count
        if self._weights[CASCADE] > self._weights[TOGETHER]:
            return self._believed
        return self._together.belief(count)

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def _weigh(self, i: int) -> None:
        """Let both predict window i before they learn it."""
        estimate = _core.Estimate(self._believed.mean, self._believed.covariance)
        scored = self._score.score(
            self._cascade.motion, estimate, self._windows.track(i), self._windows.segments[i]
        )
        self._together.belief(i + 1)
        scores = self._scores(scored)
        self._weights = np.array(_core.reweighed(self._weights, scores, EQUAL, self._weighing))
        self._believed = self._cascade.belief(i + 1, np.array(self._score.noise_scale))
        if self._recorder is not None:
            self._recorder.weigh(i, self._weights)
            self._recorder.record(i, scored.nis, 1.0, self._believed)
            self._recorder.mark(i, self._cascade.change(i), self._believed)

    def _scores(self, cascade: _core.ScoredSegment) -> Floats:
        """Log scores of both: judged by their errors, as bases are."""
        both = (self._update, cascade)  # of the window that both have just predicted
        innovations = [seen.innovation for seen in both]
        covariances = [seen.innovation_covariance for seen in both]
        return np.array(_core.common_log_scores(self._weights, innovations, covariances))

    def _see(self, i: int, update: _core.IekfUpdate, belief: Belief) -> None:
        self._update = update
        if self._recorder is not None:
            self._recorder.record(i, update.nis, update.weight, belief)
            self._recorder.mark(i, self._average.change, belief)
