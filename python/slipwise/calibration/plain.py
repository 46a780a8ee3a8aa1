# SPDX-License-Identifier: Apache-2.0
"""Methods that learn nothing: the kinematic baseline, a vendor's multiplier, and a model from a file."""

from __future__ import annotations

from functools import partial

import numpy as np

from slipwise import _core
from slipwise.calibration.learner import Posterior
from slipwise.calibration.predictors import Predictor
from slipwise.calibration.settings import Settings
from slipwise.errors import SettingsError
from slipwise.models.model import Model
from slipwise.prediction import student_at


def baseline_predictor(settings: Settings) -> Predictor:
    """`none`: the robot does at once and exactly what it is commanded."""
    model = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    return _fixed("none", model, np.zeros(0), settings)


def vendor_predictor(multiplier: float, settings: Settings) -> Predictor:
    """`vendor`: the yaw rate divided by a wheel-separation multiplier, as diff_drive_controller does.

    Raises:
        SettingsError: the multiplier is not positive.
    """
    if not (np.isfinite(multiplier) and multiplier > 0.0):
        raise SettingsError(
            "the vendor's wheel separation multiplier must be positive",
            advice="Clearpath ships 1.875 for the Husky",
        )
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    return _fixed("vendor", model, np.array([0.0, 1.0 / multiplier - 1.0]), settings)


def model_predictor(model: Model) -> Predictor:
    """`model`: a model file as it is, tails included; what the slip disturbance is now is not asked for."""
    posterior = Posterior(
        model.motion,
        model.mean,
        model.covariance,
        np.array(model.content.noise.variance_scale),
        model.prior_std,
        np.ones(len(model.mean)),
        np.ones(1),
        disturbance=_core.DisturbanceFilter(model.disturbance),
        limits=model.limits,
        car=model.car,
    )
    dynamics, student = model.content.dynamics, partial(student_at, model)
    return Predictor("model", model.noise, lambda _: posterior, dynamics, student=student)


def _fixed(method: str, model: _core.MotionModel, mean: np.ndarray, settings: Settings) -> Predictor:
    size = len(mean)
    posterior = Posterior(
        model, mean, np.zeros((size, size)), np.ones(3), np.ones(size), np.ones(size), np.ones(1)
    )
    return Predictor(method, settings.filter_settings().noise.shape, lambda _: posterior, False)
