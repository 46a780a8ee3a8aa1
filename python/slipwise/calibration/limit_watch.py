# SPDX-License-Identifier: Apache-2.0
"""Looks for the limits of the drive in wheel speeds, as they become many more, or as what was found fails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import DriveRun
from slipwise.calibration.settings import Settings

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SPACING = 0.05  # s between the wheel twists looked at
FIRST = 1000  # twists of a moving robot before the first search
GROWTH = 3.0  # each search waits for this many times the twists of the last one
AGAIN = 500  # fresh twists at least before a search because the last one's result fails
MOST = 1000  # recent twists looked at
LEAD_IN = 3.0  # s of commands before the first twist of a stretch


@dataclass(frozen=True, eq=False)
class _Twists:
    """Wheel twists of all runs that tell something: the robot moves, or is told to, by known commands."""

    position: Ints  # [N] of the run in the drive
    stretch: Ints  # [N] number of the gapless stretch
    begin: Floats  # [N] s, where that stretch begins
    rows: Floats  # [N, 3] t [s], v [m/s], omega [rad/s]


class LimitWatch:
    """Searches the last `MOST` twists, so that neither memory nor the time of a search grows with the log."""

    def __init__(self, drive: tuple[DriveRun, ...], settings: Settings) -> None:
        """Every run of `drive` has wheel speeds."""
        self._drive, self._settings = drive, settings
        self._twists = _joined([_twists(k, run, settings) for k, run in enumerate(drive)])
        self._next, self._again = FIRST, 0
        self.search: _core.LimitSearch | None = None

    def look(self, position: int, t: float, *, fails: bool = False) -> bool:
        """Search what was known at `t` [s] of run `position`, if it is time to; return whether it was.

        It is time sooner where what was found `fails` to foretell the wheels. Such searches too become rarer,
        so that a drive that no limits explain costs no more than the logarithm of its length.
        """
        count = self._count(position, t)
        asked = fails and self.search is not None and count >= self._again
        if count < self._next and not asked:
            return False
        self._next = int(np.ceil(GROWTH * count))
        self._again = count + max(AGAIN, count // 2)
        records = self._records(slice(max(count - MOST, 0), count))
        prior = self._settings.filter_settings().prior
        track = self._settings.vehicle.track
        before = self.search if self.search is not None and self.search.found else None
        self.search = _core.find_limits(records, prior, track, _core.LEAST_LIMIT_GAIN, before)
        return True

    def _count(self, position: int, t: float) -> int:
        """How many twists were measured by then; earlier runs count whole."""
        first, last = np.searchsorted(self._twists.position, (position, position + 1)).tolist()
        return int(first) + int(np.searchsorted(self._twists.rows[first:last, 0], t, side="right"))

    def _records(self, chosen: slice) -> list[_core.DriveRecord]:
        twists = self._twists
        starts = np.flatnonzero(np.diff(twists.stretch[chosen], prepend=-1)) + (chosen.start or 0)
        ends = np.append(starts[1:], chosen.stop)
        records = []
        for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
            rows = np.ascontiguousarray(twists.rows[start:end])
            inputs = self._drive[int(twists.position[start])].inputs
            begin = max(float(twists.begin[start]), float(rows[0, 0]) - LEAD_IN)
            at = slice(*np.searchsorted(inputs.t, (begin, rows[-1, 0]), side="right").tolist())
            at = slice(max(at.start - 1, 0), max(at.stop, 1))
            columns = (inputs.t[at], inputs.v[at], inputs.vy[at], inputs.omega[at])
            records.append(_core.DriveRecord(_core.InputTrack(*columns), rows))
        return records


def _twists(position: int, run: DriveRun, settings: Settings) -> _Twists:
    assert run.wheels is not None
    wheels, inputs, rules = run.wheels, run.inputs, settings.rules()
    held = np.searchsorted(inputs.t, wheels.t, side="right") - 1
    known = (held >= 0) & (wheels.t - inputs.t[held] <= rules.unknown_after)
    speed = np.maximum(np.abs(inputs.v[held]), np.abs(inputs.omega[held]))
    moves = np.maximum(np.maximum(np.abs(wheels.v), np.abs(wheels.omega)), speed) > rules.still_speed
    stretch: Ints = np.cumsum(np.diff(known.astype(np.int64), prepend=0) > 0, dtype=np.int64)
    begins = wheels.t[np.flatnonzero(np.diff(stretch, prepend=0))]
    kept = _spaced(wheels.t, np.flatnonzero(known & moves))
    rows = np.column_stack((wheels.t, wheels.v, wheels.omega))[kept]
    begin = begins[stretch[kept] - 1] if len(kept) else np.empty(0)
    return _Twists(np.full(len(kept), position), stretch[kept], begin, rows)


def _spaced(t: Floats, index: Ints) -> Ints:
    """Those of the samples `index` that are the first in each `SPACING`."""
    cell = np.floor((t[index] - t[0]) / SPACING + 1e-6) if len(index) else np.empty(0)
    return index[np.flatnonzero(np.diff(cell, prepend=-1.0))]


def _joined(parts: list[_Twists]) -> _Twists:
    offsets = np.cumsum([0, *(int(part.stretch.max(initial=0)) + 1 for part in parts)])
    return _Twists(
        np.concatenate([part.position for part in parts]),
        np.concatenate([part.stretch + offset for part, offset in zip(parts, offsets, strict=False)]),
        np.concatenate([part.begin for part in parts]),
        np.concatenate([part.rows for part in parts]),
    )
