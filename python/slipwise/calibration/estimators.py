# SPDX-License-Identifier: Apache-2.0
"""An estimator chosen by name: what it learns, and the windows that it wants."""

from __future__ import annotations

from dataclasses import replace

from slipwise import _core
from slipwise.calibration.core_learners import EstimatorLearner
from slipwise.calibration.drive import WindowSet, collect_windows
from slipwise.calibration.learner import make_learner
from slipwise.calibration.settings import Settings

ESTIMATOR_BASIS = "odd-even-10"  # where the settings leave the basis to the average
THESIS_WINDOW = 5.0  # s
THESIS_STRIDE = 0.05  # s: 20 updates per second


def estimator_basis(settings: Settings) -> str:
    """Return the basis that a single estimator learns: that of the settings, or odd-even-10 for `auto`."""
    return ESTIMATOR_BASIS if settings.basis == "auto" else settings.basis


def estimator_motion(name: str, settings: Settings, input_name: str) -> _core.MotionModel:
    """Return the model that an estimator learns; those of the thesis have no lag, delay or clock offset."""
    chosen = settings.model_copy(update={"basis": estimator_basis(settings)})
    learner = make_learner(chosen, input_name)
    thesis = _core.learns_overlapping_segments(name)
    return _core.MotionModel(
        learner.bases[0], learner.dynamics and not thesis, learner.clock_offset and not thesis
    )


def estimator_learner(name: str, motion: _core.MotionModel, settings: Settings) -> EstimatorLearner:
    """Return the estimator before any data.

    Raises:
        ValueError: there is no such estimator.
    """
    return EstimatorLearner(
        _core.FollowingEstimator(name, motion, settings.filter_settings(), settings.estimator_settings())
    )


def fed_windows(name: str, settings: Settings, windows: WindowSet) -> WindowSet:
    """Return the windows that an estimator learns while `windows` pass: the thesis's see overlapping ones."""
    if not _core.learns_overlapping_segments(name):
        return windows
    rules = replace(settings.rules(), whole_frames=True, stride=THESIS_STRIDE)
    return collect_windows(windows.drive, settings.window.length or THESIS_WINDOW, rules)
