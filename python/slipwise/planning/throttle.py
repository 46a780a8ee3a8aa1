# SPDX-License-Identifier: Apache-2.0
"""Rollouts of a car commanded by throttle and steering: its curves first, then as rollouts of twists."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.axes import THROTTLE, TWIST
from slipwise.models.model import Model
from slipwise.planning.start import Start

Numbers = NDArray[Any]  # float32 or float64
_LARGEST = 1.001  # of a command, with rounding


def behind_curves(
    model: Model, commands: Numbers, dt: float, start: Start, threads: int = 1
) -> tuple[Numbers, Start]:
    """Return the twists that the model's actuator is given over each period, and the start with those before.

    Those of a model of speeds are its commands.

    Args:
        model: a learned model.
        commands: [N, K, axes] speed [m/s] and yaw rate [rad/s]; of a car, throttle and steering.
        dt: time that a command is held [s].
        start: where the rollouts start; its drive is measured (v, omega), its past holds commands.
        threads: the results are the same bytes for any number.

    Raises:
        SettingsError: a throttle or a steering is beyond 1, or a shape does not fit.
    """
    car = model.car
    if car is None:
        return commands, start
    rollouts, periods = commands.shape[:2]
    rows = start.rows(rollouts, TWIST, sent=THROTTLE)
    for values in (commands, rows.past):
        low, high = float(values.min(initial=0.0)), float(values.max(initial=0.0))
        if not (low >= -_LARGEST and high <= _LARGEST):
            raise SettingsError(
                "a throttle or steering is not within [-1, 1]",
                advice="the model is of a car that takes these",
            )
    starts = _core.StartList(
        np.hstack((rows.pose, TWIST.twists(rows.drive))), np.ascontiguousarray(THROTTLE.twists(rows.past))
    )
    made = np.empty((2, periods, rollouts), commands.dtype)
    before = _core.car_twists(car, commands, starts, dt, made, threads)
    past = None if start.past is None else np.asarray(before).reshape(rows.past.shape)
    return made.transpose(2, 1, 0), replace(start, past=past)
