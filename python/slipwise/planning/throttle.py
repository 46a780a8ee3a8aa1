# SPDX-License-Identifier: Apache-2.0
"""Rollouts of a car commanded by throttle and steering: its curves first, then as rollouts of twists."""

from __future__ import annotations

from collections.abc import Callable
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


def behind_curves(  # noqa: PLR0913  (the last two have defaults)
    model: Model,
    commands: Numbers,
    dt: float,
    start: Start,
    threads: int = 1,
    car: _core.CarCurves | None = None,
) -> tuple[Numbers, Start]:
    """Return the twists that the model's actuator is given over each period, and the start with those before.

    Those of a model of speeds are its commands.

    Args:
        model: a learned model.
        commands: [N, K, axes] speed [m/s] and yaw rate [rad/s]; of a car, throttle and steering.
        dt: time that a command is held [s].
        start: where the rollouts start; its drive is measured (v, omega), its past holds commands.
        threads: the results are the same bytes for any number.
        car: another car than the model's.

    Raises:
        SettingsError: a throttle or a steering is beyond 1, or a shape does not fit.
    """
    car = car or model.car
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


def reach_of(commands: Numbers, start: Start) -> _core.InputHistory:
    """Return the least and the largest throttle and steering of a batch, as the core takes commands."""
    given = np.concatenate(
        (commands.reshape(-1, 2), start.rows(len(commands), TWIST, sent=THROTTLE).past.reshape(-1, 2))
    )
    ends = np.vstack((given.min(axis=0), given.max(axis=0))).astype(np.float64)
    return _core.InputHistory(np.array([0.0, 1.0]), ends[:, 0].copy(), np.zeros(2), ends[:, 1].copy())


def curve_covariance(
    model: Model, commands: Numbers, dt: float, start: Start, paths: Callable[[Numbers, Start], Numbers]
) -> NDArray[np.float64] | None:
    """Return the covariance [6, K, N] of every pose from what a car never showed of its curves, if it is one.

    Args:
        model: a learned model.
        commands: [N, K, 2] of throttle and steering.
        dt: time that a command is held [s].
        start: as `behind_curves` takes it.
        paths: rolls out the twists that curves make, to [3, K, N].
    """
    if model.car is None:
        return None
    rollouts, periods = commands.shape[:2]
    total = np.zeros((6, periods, rollouts))
    cars, step = model.car.deviations(reach_of(commands, start))
    numbers = commands.astype(np.float64)
    expected = paths(*behind_curves(model, numbers, dt, start))
    for car in cars:
        x, y, yaw = (paths(*behind_curves(model, numbers, dt, start, car=car)) - expected) / step
        total += np.stack((x * x, x * y, y * y, x * yaw, y * yaw, yaw * yaw))
    return total
