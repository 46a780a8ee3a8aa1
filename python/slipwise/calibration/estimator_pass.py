# SPDX-License-Identifier: Apache-2.0
"""A causal pass of one on-line estimator, chosen by name, fed with windows as that estimator wants them."""

from __future__ import annotations

from dataclasses import replace

from slipwise import _core
from slipwise.calibration.causal_pass import CausalPass
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
    """Return the model that an estimator learns; those of the thesis have no lag, delay, offset or mount."""
    chosen = settings.model_copy(update={"basis": estimator_basis(settings)})
    learner = make_learner(chosen, input_name)
    thesis = _core.learns_overlapping_segments(name)
    motion = _core.MotionModel(
        learner.bases[0], learner.dynamics and not thesis, learner.clock_offset and not thesis
    )
    return motion.with_mount(learner.mount and not thesis)


def estimator_pass(
    name: str, motion: _core.MotionModel, settings: Settings, windows: WindowSet
) -> CausalPass[_core.IekfUpdate]:
    """Return a pass of the estimator in the order of time.

    `windows` count as learned; estimators of the thesis see overlapping ones until the same time.

    Raises:
        ValueError: there is no such estimator.
    """
    estimator = _core.FollowingEstimator(
        name, motion, settings.filter_settings(), settings.estimator_settings()
    )
    learner = EstimatorLearner(estimator)
    if not _core.learns_overlapping_segments(name):
        return CausalPass(learner, windows)
    rules = replace(settings.rules(), whole_frames=True, stride=THESIS_STRIDE)
    length = settings.window.length or THESIS_WINDOW
    return CausalPass(learner, collect_windows(windows.drive, length, rules), pace=windows)
