# SPDX-License-Identifier: Apache-2.0
"""From commands: chain and slip learned together, in cascade, or behind limits, whichever predicts better."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from slipwise import _core
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.core_learners import AverageLearner
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.history_recorder import HistoryRecorder
from slipwise.calibration.learner import CASCADE, LIMITS, STRUCTURES, TOGETHER, Belief
from slipwise.calibration.limit_watch import LimitWatch
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.settings import Settings
from slipwise.calibration.wheel_drive import has_wheels

PATIENCE = 0.3  # of the bases' learning rate: what sets structures apart repeats from window to window
JOINING = 0.1  # part of the cascade's weight that it gives to itself behind limits, when these are found


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


@dataclass(eq=False)
class _Contender:
    """A cascade that predicts each window before it learns it."""

    passing: CascadePass
    score: _core.PredictiveScore
    believed: Belief

    def predict(self, windows: WindowSet, i: int) -> _core.ScoredSegment:
        """Score the prediction of window i."""
        belief = self.believed
        estimate = _core.Estimate(belief.mean, belief.covariance)
        track = windows.track(i, belief.limited)
        return self.score.score(self.passing.motion, estimate, track, windows.segments[i])

    def learn(self, count: int) -> None:
        """Believe what is known once `count` windows have passed."""
        self.believed = self.passing.belief(count, np.array(self.score.noise_scale))

    def behind(self, limited: LimitedDrive, count: int) -> _Contender:
        """Return the same behind the limits found in the first `count` windows."""
        passing = copy(self.passing)  # the slip is learned once, for both
        passing.restart_behind(limited)
        other = _Contender(passing, _core.PredictiveScore(self.score), self.believed)
        other.learn(count)
        return other


class StructureChoice:
    """Runs all causally and weighs them by their predictive likelihood, as bases are weighed.

    Predictions are those of the heaviest: they have different parameters, which have no mean. The one behind
    limits joins with a part of the cascade's weight once wheel speeds show limits.
    """

    def __init__(
        self,
        average: _core.ModelAverage,
        windows: WindowSet,
        settings: Settings,
        recorder: HistoryRecorder | None = None,
    ) -> None:
        """`recorder` keeps the beliefs of all, and their weights."""
        self._windows, self._weighing = windows, settings.average_settings().weighing
        self._weighing.learning_rate *= PATIENCE
        self._average = AverageLearner(average)
        self._together = CausalPass(self._average, windows, self._see)
        passing = CascadePass(windows, settings)
        score = _core.PredictiveScore(settings.filter_settings().noise)
        self._contenders = [_Contender(passing, score, passing.belief(0, np.array(score.noise_scale)))]
        self._watch = LimitWatch(windows.drive, settings) if settings.auto.limits else None
        self._recorder = recorder
        self._weights = np.array([0.5, 0.5])
        self._learned = 0

    def belief(self, count: int) -> Belief:
        """Return the heaviest belief after `count` windows.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        if count < self._learned:
            raise ValueError(f"the belief after {count} windows is gone: {self._learned} are learned")
        for i in range(self._learned, count):
            self._weigh(i)
            self._look_for_limits(i)
        self._learned = count
        heaviest = int(np.argmax(self._weights))
        if heaviest == TOGETHER:
            return self._together.belief(count)
        return self._contenders[heaviest - CASCADE].believed

    @property
    def limits(self) -> _core.LimitSearch | None:
        """What the last search for limits found; None where there was none yet."""
        return None if self._watch is None else self._watch.search

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def _weigh(self, i: int) -> None:
        """Let all predict window i before they learn it."""
        scored = [contender.predict(self._windows, i) for contender in self._contenders]
        self._together.belief(i + 1)
        innovations = [self._update.innovation, *(seen.innovation for seen in scored)]
        covariances = [self._update.innovation_covariance, *(seen.innovation_covariance for seen in scored)]
        scores = _core.common_log_scores(self._weights, innovations, covariances)  # by errors, as bases are
        equal = np.full(len(self._weights), 1.0 / len(self._weights))
        self._weights = np.array(_core.reweighed(self._weights, scores, equal, self._weighing, i))
        for contender in self._contenders:
            contender.learn(i + 1)
        self._record(i, [seen.nis for seen in scored])

    def _record(self, i: int, nis: list[float]) -> None:
        """Until limits are found, what lies behind them is the cascade itself."""
        if self._recorder is None:
            return
        weights = np.zeros(len(STRUCTURES))
        weights[: len(self._weights)] = self._weights
        self._recorder.weigh(i, weights)
        change = self._contenders[0].passing.change
        beliefs = [contender.believed for contender in self._contenders]
        if len(beliefs) == 1:
            beliefs, nis = [*beliefs, replace(beliefs[0], structure=LIMITS)], nis * 2
        for belief, value in zip(beliefs, nis, strict=True):
            self._recorder.record(i, value, 1.0, belief)
            self._recorder.mark(i, change, belief)

    def _look_for_limits(self, i: int) -> None:
        """Once window i is learned, see whether the wheels show other limits than before."""
        if self._watch is None:
            return
        fails = self._contenders[-1].passing.chain_fails
        if not self._watch.look(int(self._windows.position[i]), float(self._windows.end[i]), fails=fails):
            return
        search, cascade = self._watch.search, self._contenders[0]
        together, cascades = self._weights[TOGETHER], self._weights[1:].sum()
        if search is None or not search.found:
            self._contenders, self._weights = [cascade], np.array([together, cascades])
            return
        if len(self._contenders) == 1:
            self._weights = np.array([together, (1.0 - JOINING) * cascades, JOINING * cascades])
        limited = LimitedDrive(tuple(run.track for run in self._windows.drive), search.limits)
        self._contenders = [cascade, cascade.behind(limited, i + 1)]

    def _see(self, i: int, update: _core.IekfUpdate, belief: Belief) -> None:
        self._update = update
        if self._recorder is not None:
            self._recorder.record(i, update.nis, update.weight, belief)
            self._recorder.mark(i, self._average.change, belief)
