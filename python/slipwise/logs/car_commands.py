# SPDX-License-Identifier: Apache-2.0
"""Throttle and steering without units: kept as they are, beside what a car is known to make of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.errors import LogError
from slipwise.logs.log import CarCommands, Log, Run
from slipwise.logs.options import LogOptions

_LARGEST = 1.001  # of a command, with rounding


def with_car_commands(log: Log, options: LogOptions) -> Log:
    """Return the log of a car commanded by throttle and steering, with about what it makes of them.

    Each command is taken by curves that were known half a second before it; a learner learns them again.

    Raises:
        LogError: a command is beyond 1.
    """
    car = options.car
    if car is None or not any(run.commands is not None for run in log.runs):
        return log
    where = log.sources[0].path if log.sources else ""
    settings = _core.StreamSettings()
    settings.car = _core.CarPrior(car.top_speed, car.curvature, None)
    settings.unknown_after = options.unknown_after
    found = _core.expected_commands(settings, [_recording(run, where) for run in log.runs])
    runs = []
    for run, rows in zip(log.runs, found, strict=True):
        given = run.commands
        if given is None:
            runs.append(run)
            continue
        car_commands = CarCommands(given.v, given.omega, car.top_speed, car.curvature)
        v, vy, omega = (np.ascontiguousarray(rows[:, k]) for k in (1, 2, 3))
        runs.append(replace(run, commands=replace(given, v=v, vy=vy, omega=omega, car=car_commands)))
    note = f"commands are throttle and steering of {options.vehicle}, whose curves are learned"
    return replace(log, runs=tuple(runs), notes=(*log.notes, note))


def beyond_words(throttle: float, steering: float) -> str:
    """Say which command is larger than it can be; empty where none is."""
    for name, value in (("throttle", throttle), ("steering", steering)):
        if abs(value) > _LARGEST:
            return f"{name} reaches {abs(value):.3g}, and must be in [-1, 1]"
    return ""


def _recording(run: Run, where: str) -> _core.Recording:
    none = np.empty((0, 4))
    given = run.commands
    if given is None:
        commands = none
    else:
        beyond = beyond_words(float(np.abs(given.v).max()), float(np.abs(given.omega).max()))
        if beyond:
            raise LogError(beyond, where=where, advice="--command-scale divides it")
        commands = given.rows()
    # The direction of the path looks ahead; where there is no heading, the core takes courses of its own.
    return _core.Recording(commands, none, np.empty((0, 3)), run.poses.rows())
