# SPDX-License-Identifier: Apache-2.0
"""Futures drawn from what was learned, for planners that weigh risks."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.models.axes import drive_axes
from slipwise.models.car import drawn_cars
from slipwise.models.model import Model
from slipwise.planning.rollout import Numbers, check_threads, checked_commands, uncertain
from slipwise.planning.start import Start
from slipwise.planning.throttle import behind_curves, reach_of


def sample_futures(  # noqa: PLR0913  (all but the first three are options)
    model: Model,
    commands: ArrayLike,
    dt: float,
    *,
    samples: int,
    seed: int,
    start: Start | None = None,
    threads: int = 1,
    dtype: DTypeLike | None = None,
) -> Numbers:
    """Draw S samples of every rollout: x, y [m] and yaw [rad] after each period, [3, S, K, N].

    A sample drives all commands with parameters of its own; each of its rollouts has slip noise of its own.
    Both are widened as held-out predictions at the rollouts' end needed. The same seed gives the same bytes.

    Args:
        model: a learned model.
        commands: [N, K, 2] speed [m/s] and yaw rate [rad/s], each held for `dt`; of a car that is
            commanded by throttle and steering, these; of a robot that drives sideways [N, K, 3] v, vy, omega.
        dt: time that a command is held [s].
        samples: how many futures to draw of each rollout.
        seed: where the random numbers start, at least 0.
        start: where the rollouts start; by default at rest in the origin.
        threads: the results are the same bytes for any number.
        dtype: float32 or float64; by default that of the commands.

    Raises:
        ModelError: the model does not remember a surface ahead.
        SettingsError: as for `rollout`, and when there is no sample or the seed is negative.
    """
    numbers = checked_commands(model, commands, dtype)
    check_threads(threads)
    if samples < 1 or seed < 0:
        raise SettingsError(
            f"{samples} samples from seed {seed} cannot be drawn",
            advice="use at least 1 sample, and a seed from 0",
        )
    begin = Start() if start is None else start
    rollouts, periods = numbers.shape[:2]
    cars: list[_core.CarCurves | None] = [None]
    if model.car is not None:  # each sample has a car of its own
        deviations = model.car.deviations(reach_of(numbers, begin))
        cars = [*drawn_cars(model.table, deviations, samples, seed)]
    results = []
    for k, car in enumerate(cars):
        result = np.empty((3, samples // len(cars), periods, rollouts), numbers.dtype)
        twists, driven = behind_curves(model, numbers, dt, begin, threads, car)
        try:
            widened = uncertain(model, dt, driven, dt * periods)
            starts = driven.in_core(rollouts, drive_axes(model))
            _core.sample_futures(widened, twists, starts, seed + k, result, threads)
        except (ValueError, TypeError) as problem:
            raise SettingsError(str(problem)) from problem
        results.append(result)
    return results[0] if len(results) == 1 else np.concatenate(results, axis=1)
