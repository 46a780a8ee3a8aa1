# SPDX-License-Identifier: Apache-2.0
"""The last wheel twists of a drive that moves, and the commands that led to them, in bounded memory."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.drive import DriveRun
from slipwise.segments import WindowRules

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

SPACING = 0.05  # s between the wheel twists kept
LEAD_IN = 3.0  # s of commands before the first twist of a stretch; no drive remembers more of them
PAUSE = 10.0  # s without a twist worth keeping, after which a stretch begins anew


@dataclass(eq=False)
class _Stretch:
    """Twists without a gap in the commands, and the commands from `LEAD_IN` before the first on."""

    begin: float  # s; the commands before are another stretch's, or unknown
    rows: Floats  # [N, 3] t [s], v [m/s], omega [rad/s]
    commands: Floats  # [M, 4] t [s], v, vy [m/s], omega [rad/s]

    def extend(self, rows: Floats, commands: Floats) -> None:
        """Add twists that follow, and the run's `commands` until the last of them."""
        taken = _between(commands, float(self.commands[-1, 0]), float(rows[-1, 0]))[1:]
        self.rows = np.concatenate((self.rows, rows))
        self.commands = np.concatenate((self.commands, taken))

    def drop(self, count: int) -> None:
        """Let go of the first `count` twists, and of the commands that only they needed."""
        self.rows = self.rows[count:].copy()
        since = max(self.begin, float(self.rows[0, 0]) - LEAD_IN)
        first = int(np.searchsorted(self.commands[:, 0], since, side="right")) - 1
        self.commands = self.commands[max(first, 0) :].copy()

    def record(self) -> _core.DriveRecord:
        """Return it as the core takes it."""
        columns = (np.ascontiguousarray(column) for column in self.commands.T)
        return _core.DriveRecord(_core.InputTrack(*columns), np.ascontiguousarray(self.rows))


class RecentTwists:
    """Reads a drive forward and keeps the last `most` twists that tell something.

    A twist tells something where the robot moves, or is told to, by known commands. Kept beside the twists
    are the commands since `LEAD_IN` before each stretch of them: what is kept does not grow with the log.
    """

    def __init__(self, drive: tuple[DriveRun, ...], rules: WindowRules, most: int) -> None:
        """Start before the first run; every run of `drive` has wheel speeds."""
        self._drive, self._rules, self._most = drive, rules, most
        self._stretches: deque[_Stretch] = deque()
        self._count = 0
        self._start_run(0)

    @property
    def count(self) -> int:
        """How many twists were worth keeping so far."""
        return self._count

    @property
    def kept(self) -> tuple[int, int]:
        """How many twists and how many commands are kept."""
        return sum(len(s.rows) for s in self._stretches), sum(len(s.commands) for s in self._stretches)

    def read(self, position: int, t: float) -> None:
        """Take in what was measured until `t` [s] of run `position`, and all of the runs before it."""
        while self._position < position:
            self._read_to(np.inf)
            self._start_run(self._position + 1)
        self._read_to(t)

    def records(self) -> list[_core.DriveRecord]:
        """Return what is kept, in order of time."""
        return [stretch.record() for stretch in self._stretches]

    def _start_run(self, position: int) -> None:
        self._position, self._read = position, 0
        self._commands = self._drive[position].track.rows()  # [M, 4] without repeats
        self._known, self._begin, self._cell = False, 0.0, -1.0
        self._open = False  # whether what follows may belong to the last stretch

    def _read_to(self, t: float) -> None:
        wheels = self._drive[self._position].wheels
        assert wheels is not None
        until = int(np.searchsorted(wheels.t, t, side="right"))
        if until <= self._read:
            return
        fresh = slice(self._read, until)
        rows = np.column_stack((wheels.t[fresh], wheels.v[fresh], wheels.omega[fresh]))
        self._read = until
        known, moves = self._known_and_moving(rows)
        begins = np.flatnonzero(known & ~np.concatenate(([self._known], known[:-1])))
        self._known = bool(known[-1])
        told = self._spaced(rows[:, 0], known & moves, float(wheels.t[0]))
        for first, last in zip([0, *begins.tolist()], [*begins.tolist(), len(rows)], strict=True):
            if first in begins:
                self._begin, self._open = float(rows[first, 0]), False
            self._keep(rows[told[(told >= first) & (told < last)]])
        self._trim()

    def _known_and_moving(self, rows: Floats) -> tuple[Bools, Bools]:
        inputs, rules = self._drive[self._position].inputs, self._rules
        held = np.searchsorted(inputs.t, rows[:, 0], side="right") - 1
        known = (held >= 0) & (rows[:, 0] - inputs.t[held] <= rules.unknown_after)
        asked = np.maximum(np.abs(inputs.v[held]), np.abs(inputs.omega[held]))
        return known, np.maximum(np.abs(rows[:, 1:]).max(axis=1), asked) > rules.still_speed

    def _spaced(self, t: Floats, worth: Bools, origin: float) -> NDArray[np.int64]:
        """Indices of those that are the first in each `SPACING`."""
        index = np.flatnonzero(worth)
        cell = np.floor((t[index] - origin) / SPACING + 1e-6)
        new = np.flatnonzero(np.diff(cell, prepend=self._cell))
        self._cell = float(cell[-1]) if len(cell) else self._cell
        return index[new]

    def _keep(self, rows: Floats) -> None:
        """Add twists of one stretch, which a long pause cuts in two."""
        for part in np.split(rows, np.flatnonzero(np.diff(rows[:, 0]) > PAUSE) + 1):
            if not len(part):
                continue
            if self._open and part[0, 0] - self._stretches[-1].rows[-1, 0] <= PAUSE:
                self._stretches[-1].extend(part, self._commands)
            else:
                since = max(self._begin, float(part[0, 0]) - LEAD_IN)
                commands = _between(self._commands, since, float(part[-1, 0]))
                self._stretches.append(_Stretch(self._begin, part, commands))
            self._open = True
            self._count += len(part)

    def _trim(self) -> None:
        spare = self.kept[0] - self._most
        while spare > 0:
            oldest = self._stretches[0]
            if len(oldest.rows) <= spare:
                spare -= len(oldest.rows)
                self._stretches.popleft()
            else:
                oldest.drop(spare)
                return


def _between(commands: Floats, since: float, until: float) -> Floats:
    """Those that act from `since` to `until` [s]: the one held at `since` is the first."""
    first, last = np.searchsorted(commands[:, 0], (since, until), side="right").tolist()
    return commands[max(first - 1, 0) : max(last, 1)]
