# SPDX-License-Identifier: Apache-2.0
"""How noisy a robot drives by its model: at which speeds that is asked, and the answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.models.model import Model
from slipwise.prediction import student_at

Floats = NDArray[np.float64]

REFERENCE_FRACTION = 0.5  # of the fastest speed and yaw rate that the log holds
_SETTLED = 16384.0  # s after a command; no actuator is slower
_BRIEF = 2.0**-10  # s; the robot hardly turns in it
_NO_NOISE = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class ReferenceDrive:
    """The speed [m/s] and yaw rate [rad/s] at which noise is stated, half of the fastest in the log."""

    speed: float
    yaw_rate: float


def reference_drive(model: Model) -> ReferenceDrive:
    """Return where the model's noise is to be stated.

    Raises:
        ModelError: the robot never drove, or never turned.
    """
    span = model.content.range
    speed = REFERENCE_FRACTION * max(map(abs, span.speed))
    yaw_rate = REFERENCE_FRACTION * max(map(abs, span.yaw_rate))
    if not (speed > 0.0 and yaw_rate > 0.0):
        raise ModelError(
            "the range of validity has no speed or no yaw rate, so noise cannot be stated",
            advice="calibrate with a log in which the robot drives and turns",
        )
    return ReferenceDrive(speed, yaw_rate)


def motion_covariance(model: Model, drive: tuple[float, float], seconds: float) -> Floats:
    """Return the covariance [3, 3] of the pose (x, y, yaw) after `seconds` at (v, omega), settled.

    It is what `predict` says, less the noise of the two measured poses.
    """
    model, noise = model.body, model.noise
    slip_only = _core.MotionNoise(noise.psd_time, noise.psd_motion, noise.fraction, 0.0, 0.0)
    covariance = _spread(model, _settled(model, drive, seconds), slip_only, model.covariance_over(seconds))
    return np.asarray(covariance * student_at(model, seconds).inflation, dtype=np.float64)


def slip_density(model: Model, drive: tuple[float, float], seconds: float) -> Floats:
    """Return white noise of the slip rates [3] (m^2/s, m^2/s, rad^2/s) that is as large after `seconds`.

    What is white already keeps its density. What lasts, the constant slip, the parameters' error and the slip
    that disturbed about them, has a variance of c t^2 over that time, and counts as density c * seconds.
    """
    model, noise = model.body, model.noise
    white = _core.MotionNoise(noise.psd_time, noise.psd_motion, _NO_NOISE, 0.0, 0.0)
    lasting = _core.MotionNoise(_NO_NOISE, _NO_NOISE, noise.fraction, 0.0, 0.0)
    at = _settled(model, drive, _BRIEF)
    density = np.diag(_spread(model, at, white, np.zeros_like(model.covariance))) / _BRIEF
    density = (
        density + np.diag(_spread(model, at, lasting, model.covariance_over(seconds))) / _BRIEF**2 * seconds
    )
    return np.asarray(density * student_at(model, seconds).inflation, dtype=np.float64)


def learned_variances(model: Model, of_model: Callable[[Model], Floats]) -> list[LearnedNumber]:
    """Return variances, which `of_model` gives of a model, as learned numbers.

    The part of one that comes from parameters which the log does not determine is a guess.
    """
    numbers = LearnedNumbers(model)
    found = []
    for value, learned in zip(of_model(model).tolist(), of_model(_identifiable(model)).tolist(), strict=True):
        guessed = 1.0 - learned / value if value > 0.0 else 0.0
        found.append(numbers.variance(value, guessed=guessed))
    return found


def _identifiable(model: Model) -> Model:
    """Return the model as if the parameters that the log does not determine were known exactly."""
    table = model.table
    known = np.array([row.identifiable for row in table.rows], dtype=bool)
    if known.all():
        return model
    covariance = np.where(known[:, None] & known, table.covariance, 0.0)
    return model.with_table(table.moved(table.values, covariance))


def _settled(model: Model, drive: tuple[float, float], seconds: float) -> _core.SegmentLinearization:
    """Return a stretch of a drive whose command was given long before."""
    v, omega = drive
    history = _core.InputHistory(*(np.array([value]) for value in (0.0, v, 0.0, omega)))
    segment = _core.Segment(_SETTLED, _SETTLED + seconds, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    return _core.linearize_segment(model.motion, model.mean, history, segment)


def _spread(
    model: Model, at: _core.SegmentLinearization, noise: _core.MotionNoise, parameters: Floats
) -> Floats:
    scale = np.array(model.content.noise.variance_scale)
    return np.asarray(_core.prediction_covariance(at, parameters, noise, scale), dtype=np.float64)
