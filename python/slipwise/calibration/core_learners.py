# SPDX-License-Identifier: Apache-2.0
"""The core's estimators as learners of a causal pass: an average, one by name, or the chain alone."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.learner import TOGETHER, Belief


class AverageLearner:
    """An average of bases, or of one."""

    def __init__(
        self,
        average: _core.ModelAverage,
        structure: int = TOGETHER,
        *,
        places: tuple[int, ...] | None = None,
        bases: int = 0,
    ) -> None:
        """`average` has learned nothing yet; `structure` is what its beliefs are said to be.

        `places` are those of its bases among as many as `bases`, where it has but some of them.
        """
        self._average, self._structure = average, structure
        self._places, self._bases = places, bases
        self._motion = average.model
        self._belief: Belief | None = None

    def learn(
        self, inputs: _core.InputTrack, segment: _core.Segment, *, active: bool = True
    ) -> _core.IekfUpdate:
        """Learn one window; where not `active`, the first windows are learned again less often."""
        self._belief = None
        return self._average.learn(inputs, segment, active)

    def belief(self) -> Belief:
        """Return the belief of the average now."""
        if self._belief is None:
            self._belief = self._now()
        return self._belief

    @property
    def change(self) -> _core.ChangeTest:
        """The test for a change of ground that came with the last window."""
        return self._average.change

    def _now(self) -> Belief:
        state = self._average.state()
        return Belief(
            motion=self._motion,
            mean=np.array(state.estimate.mean),
            covariance=np.array(state.estimate.covariance),
            noise_scale=np.array(state.noise_scale),
            prior_std=np.array(state.prior_std),
            variance_ratio=np.array(state.variance_ratio),
            weights=self._weights(np.array(state.weights)),
            structure=self._structure,
        )

    def _weights(self, of_its_own: np.ndarray) -> np.ndarray:
        if self._places is None:
            return of_its_own
        weights = np.zeros(self._bases)
        weights[list(self._places)] = of_its_own
        return weights


class EstimatorLearner:
    """One estimator, whose prior follows the speeds and whose noise follows the residuals."""

    def __init__(self, estimator: _core.FollowingEstimator) -> None:
        """`estimator` has learned nothing yet."""
        self._estimator = estimator
        self._motion = estimator.model

    def learn(self, inputs: _core.InputTrack, segment: _core.Segment) -> _core.IekfUpdate:
        """Learn one window."""
        return self._estimator.learn(inputs, segment)

    def belief(self) -> Belief:
        """Return the belief that learning goes on from."""
        return self._stated(self._estimator.running())

    def fitted(self) -> Belief:
        """Return the estimate: the belief, or where the estimator fits all windows at once, that fit."""
        return self._stated(self._estimator.estimate())

    def _stated(self, estimate: _core.Estimate) -> Belief:
        prior_std = np.array(self._estimator.prior_std)
        return _stated(self._motion, estimate, prior_std, np.array(self._estimator.noise_scale))


class ChainLearner:
    """The chain behind commands, from the wheel speeds that are known of each window."""

    def __init__(self, learner: _core.ChainLearner) -> None:
        """`learner` has learned nothing yet."""
        self._learner = learner
        self._motion = learner.model

    def learn(self, inputs: _core.InputTrack, segment: _core.Segment) -> _core.ChainUpdate:
        """Learn one window."""
        assert segment.known_drive is not None
        return self._learner.learn(inputs, segment.known_drive, segment.start, segment.end)

    def belief(self) -> Belief:
        """Return what is believed of the chain now."""
        estimate, prior_std = self._learner.estimate(), np.array(self._learner.prior_std)
        return _stated(self._motion, estimate, prior_std, np.ones(3))


def _stated(
    motion: _core.MotionModel, estimate: _core.Estimate, prior_std: np.ndarray, noise_scale: np.ndarray
) -> Belief:
    covariance = np.array(estimate.covariance)
    return Belief(
        motion=motion,
        mean=np.array(estimate.mean),
        covariance=covariance,
        noise_scale=noise_scale,
        prior_std=prior_std,
        variance_ratio=np.diag(covariance) / prior_std**2,
        weights=np.ones(1),
    )
