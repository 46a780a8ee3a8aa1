# SPDX-License-Identifier: Apache-2.0
"""The candidates among which a structure is chosen: each predicts a window before it learns it."""

from __future__ import annotations

from copy import copy
from typing import Protocol

import numpy as np

from slipwise import _core
from slipwise.calibration.cascade_pass import CascadePass
from slipwise.calibration.core_learners import AverageLearner
from slipwise.calibration.drive import WindowSet
from slipwise.calibration.learner import BASELINE, DIRECT, Belief, Learner
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.settings import Settings


class Predicted(Protocol):
    """A window as it was predicted."""

    @property
    def innovation(self) -> np.ndarray:
        """Measured minus predicted chart, [3]."""
        ...

    @property
    def innovation_covariance(self) -> np.ndarray:
        """Covariance of that, [3, 3]."""
        ...

    @property
    def nis(self) -> float:
        """Its squared length in standard deviations."""
        ...


class Candidate(Protocol):
    """One way to predict, which learns as the windows pass."""

    def predict(self, i: int, *, active: bool) -> Predicted:
        """Predict window i, all before it being learned; `active`: predictions may be those of this one."""
        ...

    def learn(self, count: int) -> None:
        """Believe what is known once `count` windows have passed."""
        ...

    def belief(self) -> Belief:
        """Return what is believed now."""
        ...

    @property
    def weight(self) -> float:
        """How much the last window counted: 1 full, 0 left out."""
        ...

    @property
    def change(self) -> _core.ChangeTest:
        """The test for a change of ground that came with the last window."""
        ...


class AverageCandidate:
    """An average of bases that learns the windows themselves."""

    def __init__(self, learner: AverageLearner, windows: WindowSet) -> None:
        """`learner` has learned nothing yet."""
        self._learner, self._windows = learner, windows
        self.weight = 1.0

    def predict(self, i: int, *, active: bool) -> Predicted:
        """Predict window i, and learn it at once: what was predicted is part of the update."""
        update = self._learner.learn(self._windows.track(i), self._windows.segments[i], active=active)
        self.weight = update.weight
        return update

    def learn(self, count: int) -> None:
        """All is learned."""

    def belief(self) -> Belief:
        """Return the belief of the average."""
        return self._learner.belief()

    @property
    def change(self) -> _core.ChangeTest:
        """The test that came with the last window."""
        return self._learner.change


class BaselineCandidate:
    """The kinematic baseline: the robot does at once what its inputs say. Only its noise is learned."""

    def __init__(self, windows: WindowSet, settings: Settings, bases: tuple[str, ...]) -> None:
        """`bases` are those that the weights of its beliefs belong to."""
        self._windows, self._score = windows, _core.PredictiveScore(settings.filter_settings().noise)
        self._motion = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
        self._weights = np.array([float(name == "none") for name in bases])
        self.weight = 1.0
        self.change = _core.ChangeTest()

    def predict(self, i: int, *, active: bool) -> Predicted:  # noqa: ARG002
        """Predict window i."""
        nothing = _core.Estimate(np.zeros(0), np.zeros((0, 0)))
        return self._score.score(self._motion, nothing, self._windows.track(i), self._windows.segments[i])

    def learn(self, count: int) -> None:
        """There is nothing to learn but the noise, which `predict` has learned."""

    def belief(self) -> Belief:
        """Return the baseline with the noise as it is known."""
        none, noise = np.zeros(0), np.array(self._score.noise_scale)
        return Belief(
            self._motion, none, np.zeros((0, 0)), noise, none, none, self._weights, structure=BASELINE
        )


class CascadeCandidate:
    """A cascade, behind limits or not."""

    def __init__(
        self, windows: WindowSet, passing: CascadePass, score: _core.PredictiveScore, learned: int = 0
    ) -> None:
        """`passing` has learned, and `score` has judged, the first `learned` windows."""
        self._windows, self._passing, self._score = windows, passing, score
        self.weight = 1.0
        self.learn(learned)

    def predict(self, i: int, *, active: bool) -> Predicted:  # noqa: ARG002
        """Predict window i."""
        belief = self._believed
        estimate = _core.Estimate(belief.mean, belief.covariance)
        track = self._windows.track(i, belief.limited)
        return self._score.score(self._passing.motion, estimate, track, self._windows.segments[i])

    def learn(self, count: int) -> None:
        """Believe what is known once `count` windows have passed."""
        self._believed = self._passing.belief(count, np.array(self._score.noise_scale))

    def belief(self) -> Belief:
        """Return what is believed of chain and slip."""
        return self._believed

    @property
    def change(self) -> _core.ChangeTest:
        """The strongest test since the window before the last."""
        return self._passing.change

    @property
    def chain_fails(self) -> bool:
        """Whether wheel speeds leave what the chain predicts too often of late for it to be true."""
        return self._passing.chain_fails

    def behind(self, limited: LimitedDrive, count: int) -> CascadeCandidate:
        """Return the same behind the limits found in the first `count` windows."""
        passing = copy(self._passing)  # the slip is learned once, for both
        passing.restart_behind(limited)
        return CascadeCandidate(self._windows, passing, _core.PredictiveScore(self._score), count)


def together_candidate(learner: Learner, windows: WindowSet) -> AverageCandidate:
    """Return what learns all at once, from nothing."""
    return AverageCandidate(AverageLearner(learner.fresh()), windows)


def direct_candidate(learner: Learner, windows: WindowSet) -> AverageCandidate:
    """Return what learns slip and delays alone, from nothing."""
    average, places = learner.without_actuator(), learner.few_bases
    return AverageCandidate(AverageLearner(average, DIRECT, places=places, bases=len(learner.bases)), windows)


def cascade_candidate(windows: WindowSet, settings: Settings) -> CascadeCandidate:
    """Return a cascade that has learned nothing yet."""
    score = _core.PredictiveScore(settings.filter_settings().noise)
    return CascadeCandidate(windows, CascadePass(windows, settings), score)
