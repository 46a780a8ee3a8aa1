# SPDX-License-Identifier: Apache-2.0
"""How motion is explained: by slip, lag and delay, by less, or by more; whichever predicts better."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
from slipwise.calibration.core_learners import AverageLearner
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.history_recorder import HistoryRecorder
from slipwise.calibration.learner import (
    BASELINE,
    CASCADE,
    DIRECT,
    LIMITS,
    STRUCTURES,
    TOGETHER,
    Belief,
    Learner,
)
from slipwise.calibration.limit_watch import LimitWatch
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.structure_candidates import (
    BaselineCandidate,
    Candidate,
    CascadeCandidate,
    cascade_candidate,
    direct_candidate,
    together_candidate,
)
from slipwise.calibration.wheel_drive import has_wheels

PATIENCE = 0.3  # of the bases' learning rate: what sets structures apart repeats from window to window
JOINING = 0.1  # part of the cascade's weight that it gives to itself behind limits, when these are found
PRIOR = {DIRECT: 1.4, BASELINE: 2.0}  # weight at first, of others 1: of what predicts alike, the simplest
SIMPLE = (DIRECT, BASELINE)  # what these miss must not pass for noise
ACTIVE = 0.5  # of the heavier average's weight, from which on the other's windows are learned again as often
REFUTED = np.log(1e3)  # tempered log odds against a candidate from which on it is no longer learned


def learning_pass(
    learner: Learner, windows: WindowSet, recorder: HistoryRecorder | None = None
) -> CausalPass[_core.IekfUpdate] | StructureChoice:
    """Return the pass that learns as `learner` says; `auto` also tries with less, and with more."""
    if learner.settings.basis == "auto":
        choice = StructureChoice(learner, windows, recorder)
        if choice.several:
            return choice
    return average_pass(learner.fresh(), windows, recorder)


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
    """Runs all candidates causally and weighs them by their predictive likelihood, as bases are weighed.

    Predictions are those of the heaviest: they have different parameters, which have no mean. The cascade
    behind limits joins with a part of the cascade's weight once wheel speeds show limits. How a drive answers
    does not change with the ground: a simpler candidate that is refuted once is left out for good.
    """

    def __init__(self, learner: Learner, windows: WindowSet, recorder: HistoryRecorder | None = None) -> None:
        """`recorder` keeps the beliefs of all, and their weights."""
        settings = learner.settings
        self._windows, self._weighing = windows, settings.average_settings().weighing
        self._weighing.learning_rate *= PATIENCE
        self._candidates = _candidates(learner, windows)
        cascades = settings.auto.limits and CASCADE in self._candidates
        self._watch = LimitWatch(windows.drive, settings) if cascades else None
        self._recorder = recorder
        self._weights = _prior(self._candidates)
        self._evidence = dict.fromkeys(self._candidates, 0.0)  # tempered log scores so far
        self._learned = 0

    @property
    def several(self) -> bool:
        """Whether there is anything to choose."""
        return len(self._candidates) > 1

    def belief(self, count: int) -> Belief:
        """Return the heaviest belief after `count` windows.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        self._learn(count)
        return self._candidates[max(self._weights, key=self._weights.__getitem__)].belief()

    def slip_belief(self, count: int) -> Belief:
        """Return the heaviest belief after `count` windows that has slip, which the baseline has not.

        What is learned about slip, such as how it wanders, is learned about this one.

        Raises:
            ValueError: more windows than that are learned already, and nothing learned is ever unlearned.
        """
        self._learn(count)
        slipping = [s for s in self._weights if s != BASELINE]
        return self._candidates[max(slipping, key=self._weights.__getitem__)].belief()

    @property
    def limits(self) -> _core.LimitSearch | None:
        """What the last search for limits found; None where there was none yet."""
        return None if self._watch is None else self._watch.search

    def finish(self) -> Belief:
        """Learn what is left and return the last belief."""
        return self.belief(len(self._windows))

    def _learn(self, count: int) -> None:
        if count < self._learned:
            raise ValueError(f"the belief after {count} windows is gone: {self._learned} are learned")
        for i in range(self._learned, count):
            self._weigh(i)
            self._leave_out_refuted()
            self._look_for_limits(i)
        self._learned = count

    def _weigh(self, i: int) -> None:
        """Let all predict window i before they learn it."""
        predicted = {s: each.predict(i, active=self._active(s)) for s, each in self._candidates.items()}
        weights = np.array([self._weights[s] for s in predicted])
        # By their errors, as bases are, under what those miss that could explain most.
        full = np.array([s not in SIMPLE for s in predicted]) * weights
        innovations = [each.innovation for each in predicted.values()]
        covariances = [each.innovation_covariance for each in predicted.values()]
        scores = _core.common_log_scores(full / full.sum(), innovations, covariances)
        prior = np.array(list(_prior(predicted).values()))
        reweighed = _core.reweighed(weights, scores, prior, self._weighing, i)
        self._weights = dict(zip(predicted, reweighed.tolist(), strict=True))
        for s, score in zip(predicted, scores.tolist(), strict=True):
            self._evidence[s] += self._weighing.learning_rate * score
        for candidate in self._candidates.values():
            candidate.learn(i + 1)
        self._record(i, {s: each.nis for s, each in predicted.items()})

    def _active(self, structure: int) -> bool:
        """Whether a candidate may predict soon: of two averages, both that have half the other's weight."""
        averages = max(self._weights[TOGETHER], self._weights.get(DIRECT, 0.0))
        return self._weights[structure] >= ACTIVE * averages

    def _leave_out_refuted(self) -> None:
        """Leave out simpler candidates that predict far worse than another."""
        most = max(self._evidence.values())
        for s in SIMPLE:
            if s in self._candidates and most - self._evidence[s] > REFUTED:
                del self._candidates[s], self._evidence[s], self._weights[s]
        total = sum(self._weights.values())
        self._weights = {s: weight / total for s, weight in self._weights.items()}

    def _record(self, i: int, nis: dict[int, float]) -> None:
        """Until limits are found, what lies behind them is the cascade itself."""
        if self._recorder is None:
            return
        weights = np.zeros(len(STRUCTURES))
        weights[list(self._weights)] = list(self._weights.values())
        self._recorder.weigh(i, weights)
        for s, candidate in self._candidates.items():
            beliefs = [candidate.belief()]
            if s == CASCADE and LIMITS not in self._candidates:
                beliefs.append(replace(beliefs[0], structure=LIMITS))
            for belief in beliefs:
                self._recorder.record(i, nis[s], candidate.weight, belief)
                self._recorder.mark(i, candidate.change, belief)

    def _look_for_limits(self, i: int) -> None:
        """Once window i is learned, see whether the wheels show other limits than before."""
        cascade = self._candidates.get(CASCADE)
        if self._watch is None or not isinstance(cascade, CascadeCandidate):
            return
        last = self._candidates.get(LIMITS, cascade)
        fails = isinstance(last, CascadeCandidate) and last.chain_fails
        if not self._watch.look(int(self._windows.position[i]), float(self._windows.end[i]), fails=fails):
            return
        search = self._watch.search
        if search is None or not search.found:
            self._candidates.pop(LIMITS, None)
            self._evidence.pop(LIMITS, None)
            self._weights[CASCADE] += self._weights.pop(LIMITS, 0.0)
            return
        if LIMITS not in self._candidates:
            both = self._weights[CASCADE]
            self._weights[CASCADE], self._weights[LIMITS] = (1.0 - JOINING) * both, JOINING * both
            self._evidence[LIMITS] = self._evidence[CASCADE]
        limited = LimitedDrive(tuple(run.track for run in self._windows.drive), search.limits)
        self._candidates[LIMITS] = cascade.behind(limited, i + 1)


def _prior(structures: Iterable[int]) -> dict[int, float]:
    """Return the weight of each before anything is predicted; they sum to 1."""
    weights = {s: PRIOR.get(s, 1.0) for s in structures}
    total = sum(weights.values())
    return {s: weight / total for s, weight in weights.items()}


def _candidates(learner: Learner, windows: WindowSet) -> dict[int, Candidate]:
    """Return what is tried from the first window on, by structure."""
    settings = learner.settings
    found: dict[int, Candidate] = {TOGETHER: together_candidate(learner, windows)}
    if learner.dynamics and settings.auto.cascade and has_wheels(windows.drive):
        found[CASCADE] = cascade_candidate(windows, settings)
    if learner.dynamics and settings.auto.direct:
        found[DIRECT] = direct_candidate(learner, windows)
    if settings.auto.baseline:
        found[BASELINE] = BaselineCandidate(windows, settings, tuple(b.name for b in learner.bases))
    return found
