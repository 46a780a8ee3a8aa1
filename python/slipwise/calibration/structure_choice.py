# SPDX-License-Identifier: Apache-2.0
"""From commands: chain and slip learned together, in cascade, or behind limits, whichever predicts better."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.causal_pass import CausalPass, HistoryRecorder, Observer
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import Belief
from slipwise.calibration.limit_watch import LimitWatch
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.result import History
from slipwise.calibration.settings import Settings
from slipwise.calibration.wheel_drive import has_wheels

STRUCTURES = ("together", "cascade", "limits")
JOINING = 0.1  # part of the cascade's weight that it gives to itself behind limits, when these are found
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
        observer: Observer | None = None,
    ) -> None:
        """`observer` is called as by `CausalPass`, about the model learned together."""
        self._windows, self._average = windows, settings.average_settings()
        self._together = CausalPass(average, windows, self._see)
        passing = CascadePass(windows, settings)
        score = _core.PredictiveScore(settings.filter_settings().noise)
        self._cascade = _Contender(passing, score, passing.belief(0, np.array(score.noise_scale)))
        self._limited: _Contender | None = None
        self._watch = LimitWatch(windows.drive, settings) if settings.auto.limits else None
        self._observer = observer
        self._weights = np.array([0.5, 0.5])
        self._learned = 0
        names = tuple(basis.name for basis in settings.bases())
        self._records = tuple(HistoryRecorder(passing.motion, windows, names, None) for _ in STRUCTURES[1:])
        self._structure_weight = np.zeros((len(windows), len(STRUCTURES)))

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
        return self._contenders()[heaviest - 1].believed if heaviest else self._together.belief(count)

    @property
    def limits(self) -> _core.LimitSearch | None:
        """What the last search for limits found; None where there was none yet."""
        return None if self._watch is None else self._watch.search

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def history(self, together: History) -> History:
        """Return the history of the heaviest structure, with all weights; `together` is that of the first."""
        histories = (together, *(record.history for record in self._records))
        chosen = histories[int(np.argmax(self._weights))]
        return replace(chosen, structures=STRUCTURES, structure_weight=self._structure_weight)

    def _contenders(self) -> tuple[_Contender, ...]:
        return (self._cascade,) if self._limited is None else (self._cascade, self._limited)

    def _weigh(self, i: int) -> None:
        """Let all predict window i before they learn it."""
        contenders = self._contenders()
        scored = [contender.predict(self._windows, i) for contender in contenders]
        self._together.belief(i + 1)
        innovations = [self._update.innovation, *(seen.innovation for seen in scored)]
        covariances = [self._update.innovation_covariance, *(seen.innovation_covariance for seen in scored)]
        scores = np.array(_core.common_log_scores(self._weights, innovations, covariances))  # as of bases
        self._weights = np.array(_core.reweighed(self._weights, scores, self._average))
        self._structure_weight[i, : len(self._weights)] = self._weights
        for contender in contenders:
            contender.learn(i + 1)
        change = self._cascade.passing.change(i)
        for k, record in enumerate(self._records):
            of = min(k, len(contenders) - 1)
            record.record(i, scored[of].nis, 1.0, contenders[of].believed)
            record.mark(i, change)

    def _look_for_limits(self, i: int) -> None:
        """Once window i is learned, see whether the wheels show other limits than before."""
        if self._watch is None or not self._watch.look(int(self._windows.position[i]), self._windows.end[i]):
            return
        search = self._watch.search
        together, cascade = self._weights[0], self._weights[1:].sum()
        if search is None or not search.found:
            self._limited, self._weights = None, np.array([together, cascade])
            return
        if self._limited is None:
            self._weights = np.array([together, (1.0 - JOINING) * cascade, JOINING * cascade])
        commands = tuple(run.track for run in self._windows.drive)
        self._limited = self._cascade.behind(LimitedDrive(commands, search.limits), i + 1)

    def _see(self, i: int, update: _core.IekfUpdate, change: _core.ChangeTest, belief: Belief) -> None:
        self._update = update
        if self._observer is not None:
            self._observer(i, update, change, belief)
