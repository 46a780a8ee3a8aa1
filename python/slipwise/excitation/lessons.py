# SPDX-License-Identifier: Apache-2.0
"""What each move of a drive teaches: the worst prediction and every parameter, before and after it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.excitation.design import HORIZON, JUDGED_LEVELS, LEAD, Excitation
from slipwise.excitation.information import (
    WorstPrediction,
    information,
    move_jacobians,
    prediction_jacobians,
    prior_information,
)
from slipwise.excitation.moves import Move

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Lesson:
    """One move, and how sure the robot's model is after it; the first lesson has no move."""

    move: Move | None
    yaw: float  # rad, largest standard deviation of a predicted yaw
    position: float  # m, largest standard deviation of a predicted position
    std: Floats  # [parameters] standard deviations


def lessons_of(drive: Excitation) -> tuple[Lesson, ...]:
    """Return the knowledge before the drive, and after each of its moves, in the order of driving.

    Derivatives are those of the whole drive: what a move leaves of the drive's lag is in the next.
    """
    knowledge, std = drive.knowledge, drive.options.std
    judge = WorstPrediction(prediction_jacobians(knowledge, drive.space.grid(JUDGED_LEVELS), HORIZON))
    known = prior_information(knowledge)
    result = [_lesson(None, known, judge)]
    for move, jacobian in zip(drive.moves, move_jacobians(knowledge, drive.moves, LEAD), strict=True):
        known = known + information(jacobian, std)
        result.append(_lesson(move, known, judge))
    return tuple(result)


def _lesson(move: Move | None, known: Floats, judge: WorstPrediction) -> Lesson:
    yaw, position = judge.sigmas(known)
    return Lesson(move, yaw, position, np.sqrt(np.diag(np.linalg.inv(known))))
