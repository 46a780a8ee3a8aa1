# SPDX-License-Identifier: Apache-2.0
"""Where a controller's motion model comes from: constants, models of the floors, or a live learner."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from slipwise.calibration.motion_learner import MotionLearner
from slipwise.errors import SettingsError
from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.models import Model
from slipwise.planning import Motion, learned_motions

REFRESH = 1.0  # [s] between two models of a live learner
_NEWS = ("segment-learned", "refit")  # what changes its model


class MotionSource(Protocol):
    """What a drive asks for its model, once a control period."""

    def motions(self, floor: int, samples: Sequence[Sample]) -> list[Motion] | None:
        """Take what was measured; return the motions to drive through from now on, None for those before."""


class FixedMotion:
    """One model all the way."""

    def __init__(self, motions: Sequence[Motion]) -> None:
        self._first: list[Motion] | None = list(motions)

    def motions(self, floor: int, samples: Sequence[Sample]) -> list[Motion] | None:
        """Return the model at the first call, then nothing new."""
        del floor, samples
        first, self._first = self._first, None
        return first


class FloorMotions:
    """A model for each floor, exchanged the moment the floor changes, as if the robot saw its floors."""

    def __init__(self, models: Sequence[Model]) -> None:
        self._models = models
        self._floor = -1

    def motions(self, floor: int, samples: Sequence[Sample]) -> list[Motion] | None:
        """Return the floor's model where the floor is another one than before."""
        del samples
        if floor == self._floor:
            return None
        self._floor = floor
        return learned_motions(self._models[floor])


class LiveMotion:
    """A learner that drives along; its model is taken once a second where it has learned something.

    Args:
        learner: with nothing learned, or loaded from its saved state.
        until: what to drive through before the learner has a model that its verdict calls good.
    """

    def __init__(self, learner: MotionLearner, until: Sequence[Motion]) -> None:
        self.learner = learner
        self._until: list[Motion] | None = list(until)
        self._due, self._now = 0.0, 0.0
        self._learned = True  # a loaded one may have a model at once
        learner.start_run("slalom")

    def motions(self, floor: int, samples: Sequence[Sample]) -> list[Motion] | None:
        """Learn from the samples; return a model where one is due."""
        del floor
        push(self.learner, samples)
        first, self._until = self._until, None
        stamps = (sample.t for sample in samples if isinstance(sample, Command | Wheels | Pose))
        self._now = max(stamps, default=self._now)
        self._learned |= any(event.kind in _NEWS for event in self.learner.events())
        if self._now < self._due or not self._learned:
            return first
        self._due, self._learned = self._now + REFRESH, False
        model = self._model()
        return first if model is None else learned_motions(model)

    def _model(self) -> Model | None:
        """Return the learner's model where its verdict is good."""
        try:
            model = self.learner.model(limits=False)
        except SettingsError:
            return None
        return model if model.content.verdict.good else None


def push(learner: MotionLearner, samples: Sequence[Sample]) -> None:
    """Hand measurements to a learner."""
    for sample in samples:
        if isinstance(sample, Command):
            learner.push_command(sample.t, sample.v, sample.omega, sample.vy)
        elif isinstance(sample, Wheels):
            learner.push_wheels(sample.t, sample.v, sample.omega, sample.vy)
        elif isinstance(sample, Pose):
            learner.push_pose(sample.t, sample.x, sample.y, sample.yaw, sample.std_xy, sample.std_yaw)
