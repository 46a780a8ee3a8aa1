# SPDX-License-Identifier: Apache-2.0
"""What is learned causally, and the belief about its parameters at one moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.limited_drive import LimitedDrive
from slipwise.calibration.settings import Settings

Floats = NDArray[np.float64]
Progress = Callable[[float], None]

STRUCTURES = ("together", "cascade", "limits", "direct", "baseline")  # how motion is explained
TOGETHER, CASCADE, LIMITS, DIRECT, BASELINE = range(len(STRUCTURES))


@dataclass(frozen=True, eq=False)
class Belief:
    """What is believed of a model's parameters at one moment."""

    motion: _core.MotionModel  # whose parameters these are
    mean: Floats  # [P]
    covariance: Floats  # [P, P]
    noise_scale: Floats  # [3]
    prior_std: Floats  # [P]
    variance_ratio: Floats  # [P] posterior / prior variance
    weights: Floats  # [B]
    noise: _core.MotionNoise | None = None  # where the method learns its own; None: that of its forecaster
    coloured: _core.ColouredSlip | None = None  # how slip wanders about this belief, where that is learned
    start: _core.StartPose | None = None  # how far back poses tell of a start, where that is learned
    limited: LimitedDrive | None = None  # the limits in front of the chain, where some were found
    structure: int = TOGETHER  # of STRUCTURES; the errors of each are a population of their own


@dataclass(frozen=True, eq=False)
class Learner:
    """How to learn one method: its bases and what else is a parameter."""

    settings: Settings
    bases: tuple[_core.Basis, ...]
    dynamics: bool
    clock_offset: bool
    mount: bool

    def fresh(self) -> _core.ModelAverage:
        """Return the core's estimator before any data."""
        return _core.ModelAverage(
            "auto",
            list(self.bases),
            self.dynamics,
            self.clock_offset,
            self.mount,
            self.settings.filter_settings(),
            self.settings.average_settings(),
        )

    @property
    def few_bases(self) -> tuple[int, ...]:
        """Places of the two bases with the fewest terms and of the one with the most."""
        by_size = sorted(range(len(self.bases)), key=lambda i: self.bases[i].size)
        return tuple(sorted({*by_size[:2], by_size[-1]}))

    def without_actuator(self) -> _core.ModelAverage:
        """Return few bases without an actuator model: a delay per channel, and no lag behind it."""
        return _core.ModelAverage.with_delays(
            "auto",
            [self.bases[i] for i in self.few_bases],
            self.mount,
            self.settings.filter_settings(),
            self.settings.average_settings(),
        )


def make_learner(settings: Settings, input_name: str) -> Learner:
    """Return the learner that the settings ask for: commands bring lag and delay, wheels a clock offset."""
    dynamics = input_name == "command"
    offset = settings.learn_clock_offset and not dynamics
    return Learner(settings, tuple(settings.bases()), dynamics, offset, settings.mount.learn)
