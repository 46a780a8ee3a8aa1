# SPDX-License-Identifier: Apache-2.0
"""Yaw rates of a gyro beside positions: a column gyro_z or an IMU, where it turns as the inputs do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Floats, Run
from slipwise.logs.readings import number_rows
from slipwise.logs.streams import RawStream

COLUMN = "gyro_z"  # rad/s, counter-clockwise
_ENOUGH = 15  # seconds in which the inputs turn; with fewer nothing is said
_LEAST, _MOST = 0.05, 5.0  # turns of the gyro over those of the inputs
_NONE = np.empty((0, 2))
_LONGEST_STEP = 0.2  # s between rates, over which they are integrated
_FASTEST = 1e3  # rad/s; faster rates have another unit


@dataclass(frozen=True, eq=False)
class Turned:
    """How far a robot has turned by its gyro, bias included."""

    stamps: Floats  # [N] s, of the rates
    turned: Floats  # [N] rad, until then
    gaps: NDArray[np.int64]  # [N] between rates, so far

    def at(self, t: Floats) -> Floats:
        """Return how far it has turned at some times."""
        return np.asarray(np.interp(t, self.stamps, self.turned))

    def known(self, t: Floats, around: float) -> NDArray[np.bool_]:
        """Say of some times [M] whether rates came without a gap from `around` [s] before to after."""
        before = np.searchsorted(self.stamps, t - around, side="right") - 1
        after = np.searchsorted(self.stamps, t + around)
        inside = (before >= 0) & (after < len(self.stamps))
        inside[inside] = self.gaps[before[inside]] == self.gaps[after[inside]]
        return np.asarray(inside)


def turned_by(rows: Floats) -> Turned | None:
    """Integrate rows of (t, yaw rate) [N, 2]; None where there are none, or in another unit."""
    if len(rows) < 2 or not (np.abs(rows[:, 1]) < _FASTEST).all():
        return None
    stamps, rate = rows.T
    steps = np.diff(stamps)
    turned = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * steps))
    return Turned(stamps, turned, np.append(0, np.cumsum(steps > _LONGEST_STEP)))


def gyro_alone(runs: Iterable[Run]) -> bool:
    """Say whether no pose was measured, but yaw rates: turns are then all that is learned from."""
    every = tuple(runs)
    return not any(len(run.poses) for run in every) and any(len(measured_rates(run)) for run in every)


def gyro_rows(run: Run) -> Floats:
    """Return rows of (t, yaw rate) in s and rad/s, [N, 2]; none where poses tell their turns themselves."""
    rows = measured_rates(run)
    return _NONE if turns_otherwise(run, rows) else rows


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
        columns = {"t": own.t, COLUMN: own.columns[COLUMN]}
        found.append(replace(run, extra={**run.extra, **columns}) if len(own.t) else run)
    return tuple(found)


def measured_rates(run: Run) -> Floats:
    """Return rows of (t, yaw rate) in s and rad/s, [N, 2], where no pose tells a heading."""
    return _NONE if len(run.poses) and not run.poses.course else number_rows(run, COLUMN)


def turns_otherwise(run: Run, rows: Floats) -> bool:
    """Say whether yaw rates [N, 2] of a run do not go with what its inputs turn."""
    if len(rows) < 2:
        return False
    settings, none = _core.StreamSettings(), np.empty((0, 4))
    settings.unknown_after = UNKNOWN_AFTER
    commands, wheels = (none if given is None else given.rows() for given in (run.commands, run.wheels))
    recording = _core.Recording(commands, wheels, np.empty((0, 3)), np.empty((0, 7)), {COLUMN: rows})
    return any(otherwise(row) for row in _core.motion_evidence(settings, [recording]).gyro_turns)


def otherwise(turns: Floats) -> bool:
    """Say it of one run: number of seconds, then the sums of products and squares, follow its number."""
    _, seconds, product, square = turns
    return bool(seconds >= _ENOUGH and not _LEAST < product / square < _MOST)
