# SPDX-License-Identifier: Apache-2.0
"""From commands: chain and slip learned together or in cascade, whichever predicts better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.causal_pass import CausalPass, HistoryRecorder, Observer
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.result import History
from slipwise.calibration.settings import Settings
from slipwise.calibration.wheel_drive import has_wheels

STRUCTURES = ("together", "cascade")
Floats = NDArray[np.float64]


def learning_pass(
    average: _core.ModelAverage,
    windows: WindowSet,
    settings: Settings,
    observer: Observer | None = None,
) -> CausalPass | StructureChoice:
    """Return the pass that learns `average`; `auto` also tries the cascade where wheel speeds allow it."""
    tries = settings.basis == "auto" and settings.auto.cascade
    if tries and average.model.dynamics and has_wheels(windows.drive):
        return StructureChoice(average, windows, settings, observer)
    return CausalPass(average, windows, observer)


class StructureChoice:
    """Runs both causally and weighs them by their predictive likelihood, as bases are weighed.

    Predictions are those of the heavier one: the two have different parameters, which have no mean.
    """

    def __init__(
        self,
        average: _core.ModelAverage,
        windows: WindowSet,
        settings: Settings,
        observer: Observer | None = None,
    ) -> None:
        """`observer` is called as by `CausalPass`, about the model learned together."""
        self._windows, self._average = windows, settings.average_settings()
        self._together = CausalPass(average, windows, self._see)
        self._cascade = CascadePass(windows, settings)
        self._score = _core.PredictiveScore(settings.filter_settings().noise)
        self._believed = self._cascade.belief(0, np.array(self._score.noise_scale))
        self._observer = observer
        self._weights = np.full(len(STRUCTURES), 1.0 / len(STRUCTURES))
        self._learned = 0
        names = tuple(basis.name for basis in settings.bases())
        recorder = HistoryRecorder(self._cascade.motion, windows, names, None)
        self._cascade_record, self._structure_weight = recorder, np.zeros((len(windows), len(STRUCTURES)))

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
        if self._weights[1] > self._weights[0]:
            return self._believed
        return self._together.belief(count)

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def history(self, together: History) -> History:
        """Return the history of the heavier structure, with both weights; `together` is that of the other."""
        chosen = self._cascade_record.history if self._weights[1] > self._weights[0] else together
        return replace(chosen, structures=STRUCTURES, structure_weight=self._structure_weight)

    def _weigh(self, i: int) -> None:
        """Let both predict window i before they learn it."""
        estimate = _core.Estimate(self._believed.mean, self._believed.covariance)
        scored = self._score.score(
            self._cascade.motion, estimate, self._windows.track(i), self._windows.segments[i]
        )
        self._together.belief(i + 1)
        self._weights = np.array(_core.reweighed(self._weights, self._scores(scored), self._average))
        self._structure_weight[i] = self._weights
        self._believed = self._cascade.belief(i + 1, np.array(self._score.noise_scale))
        self._cascade_record.record(i, scored.nis, 1.0, self._believed)
        self._cascade_record.mark(i, self._cascade.change(i))

    def _scores(self, cascade: _core.ScoredSegment) -> Floats:
        """Log scores of both: judged by their errors, as bases are."""
        both = (self._update, cascade)  # of the window that both have just predicted
        innovations = [seen.innovation for seen in both]
        covariances = [seen.innovation_covariance for seen in both]
        return np.array(_core.common_log_scores(self._weights, innovations, covariances))

    def _see(self, i: int, update: _core.IekfUpdate, change: _core.ChangeTest, belief: Belief) -> None:
        self._update = update
        if self._observer is not None:
            self._observer(i, update, change, belief)
