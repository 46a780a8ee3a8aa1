# SPDX-License-Identifier: Apache-2.0
"""Yaw rates of a gyro beside positions: a column gyro_z or an IMU, where it turns as the inputs do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.logs.contradiction import Contradiction
from slipwise.logs.held import UNKNOWN_AFTER, HeldSum
from slipwise.logs.log import Floats, Run
from slipwise.logs.streams import RawStream

_COLUMN = "gyro_z"  # rad/s, counter-clockwise
_WINDOW = 1.0  # [s] over which turns are compared
_ENOUGH = 15  # windows in which the inputs turn; with fewer nothing is said
_TURNING = 0.1  # [rad/s] of the inputs
_LEAST, _MOST = 0.05, 5.0  # turns of the gyro over those of the inputs
_NONE = np.empty((0, 2))


def gyro_alone(runs: Iterable[Run]) -> bool:
    """Say whether no pose was measured, but yaw rates: turns are then all that is learned from."""
    every = tuple(runs)
    return not any(len(run.poses) for run in every) and any(len(_measured(run)) for run in every)


def gyro_rows(run: Run) -> Floats:
    """Return rows of (t, yaw rate) in s and rad/s, [N, 2]; none where poses tell their turns themselves."""
    rows = _measured(run)
    return _NONE if _turns_otherwise(run, rows) else rows


def with_gyro(runs: tuple[Run, ...], stream: RawStream, starts: Floats) -> tuple[Run, ...]:
    """Give each run of a bag the yaw rates that came in it, as a column.

    Args:
        runs: in the order of time, without columns of their own.
        stream: stamps [s] and rates [rad/s] in its column gyro_z.
        starts: when each run but the first begins [s].
    """
    found = []
    for number, run in enumerate(runs):
        own = stream.in_time(stream.in_run(number, starts))
        columns = {"t": own.t, _COLUMN: own.columns[_COLUMN]}
        found.append(replace(run, extra={**run.extra, **columns}) if len(own.t) else run)
    return tuple(found)


def gyro_contradictions(runs: tuple[Run, ...]) -> tuple[Contradiction, ...]:
    """Say which gyro is not used since it does not turn as the inputs do."""
    odd = [run.name for run in runs if _turns_otherwise(run, _measured(run))]
    if not odd:
        return ()
    sentence = f"the gyro does not turn as the inputs do and is left out (run {odd[0]})"
    advice = f"Give {_COLUMN} in rad/s, positive counter-clockwise seen from above."
    return (Contradiction("gyro-turns-otherwise", sentence, (advice,), spoils=False),)


def _measured(run: Run) -> Floats:
    if (len(run.poses) and not run.poses.course) or _COLUMN not in run.extra:
        return _NONE
    try:
        t, rate = (np.asarray(run.extra[name], dtype=np.float64) for name in ("t", _COLUMN))
    except ValueError:  # text
        return _NONE
    rows = np.column_stack((t, rate))
    rows = rows[np.isfinite(rows).all(axis=1)]
    return rows[np.unique(rows[:, 0], return_index=True)[1]]


def _turns_otherwise(run: Run, rows: Floats) -> bool:
    inputs = run.wheels if run.wheels is not None else run.commands
    if inputs is None or len(rows) < 2:
        return False
    start = np.arange(rows[0, 0], rows[-1, 0] - _WINDOW - _core.SAME_STAMP, _WINDOW)
    turned = HeldSum.of(inputs, inputs.omega, UNKNOWN_AFTER)
    by_inputs, known = turned.between(start, start + _WINDOW), turned.known(start, start + _WINDOW)
    steps = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(rows[:, 0]) * (rows[1:, 1] + rows[:-1, 1]))))
    by_gyro = np.interp(start + _WINDOW, rows[:, 0], steps) - np.interp(start, rows[:, 0], steps)
    turning = (np.abs(by_inputs) > _TURNING * _WINDOW) & (known > 0.9 * _WINDOW + _core.SAME_STAMP)
    if turning.sum() < _ENOUGH:
        return False
    ratio = float(by_inputs[turning] @ by_gyro[turning] / (by_inputs[turning] @ by_inputs[turning]))
    return not _LEAST < ratio < _MOST
