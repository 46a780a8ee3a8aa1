# SPDX-License-Identifier: Apache-2.0
"""Rollouts of a car commanded by throttle and steering: its curves first, then as rollouts of twists."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError
from slipwise.models.axes import THROTTLE, TWIST
from slipwise.models.model import Model
from slipwise.planning.start import Start

Numbers = NDArray[Any]  # float32 or float64
_LARGEST = 1.001  # of a command, with rounding


def behind_curves(model: Model, commands: Numbers, dt: float, start: Start) -> tuple[Numbers, Start]:
    """Return the twists that the model's actuator is given over each period, and the start with those before.

    Those of a model of speeds are its commands.

    Args:
        model: a learned model.
        commands: [N, K, axes] speed [m/s] and yaw rate [rad/s]; of a car, throttle and steering.
        dt: time that a command is held [s].
        start: where the rollouts start; its drive is measured (v, omega), its past holds commands.

    Raises:
        SettingsError: a throttle or a steering is beyond 1, or a shape does not fit.
    """
    car = model.car
    if car is None:
        return commands, start
    rollouts, periods = commands.shape[:2]
    rows = start.rows(rollouts, TWIST, sent=THROTTLE)
    for values in (commands, rows.past):
        if not np.isfinite(values).all() or np.abs(values).max(initial=0.0) > _LARGEST:
            raise SettingsError(
                "a throttle or steering is not within [-1, 1]",
                advice="the model is of a car that takes these",
            )
    flat = np.ascontiguousarray(commands.reshape(rollouts, 2 * periods), np.float64)
    twists, past = car.rollouts(flat, rows.drive, rows.past.reshape(len(rows.past), -1), dt)
    made = twists.reshape(rollouts, periods, 2).astype(commands.dtype)
    before = None if start.past is None else past.reshape(rows.past.shape)
    return made, replace(start, past=before)
