# SPDX-License-Identifier: Apache-2.0
"""Looks for the limits of the drive in wheel speeds, as they become many more, or as what was found fails."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.drive import DriveRun
from slipwise.calibration.recent_twists import RecentTwists
from slipwise.calibration.settings import Settings

FIRST = 1000  # twists of a moving robot before the first search
GROWTH = 3.0  # each search waits for this many times the twists of the last one
GROWTH_FAILING = 2.0  # the same where the last one's result fails
MOST = 1000  # recent twists looked at; 50 s of driving hold each kind of change many times


class LimitWatch:
    """Searches the last `MOST` twists, so that neither memory nor the time of a search grows with the log."""

    def __init__(self, drive: tuple[DriveRun, ...], settings: Settings) -> None:
        """Every run of `drive` has wheel speeds."""
        self._settings = settings
        self._twists = RecentTwists(drive, settings.rules(), MOST)
        self._next, self._again = FIRST, 0
        self.search: _core.LimitSearch | None = None

    @property
    def kept(self) -> tuple[int, int]:
        """How many wheel twists and how many commands are kept for the next search."""
        return self._twists.kept

    def look(self, position: int, t: float, *, fails: bool = False) -> bool:
        """Search what was known at `t` [s] of run `position`, if it is time to; return whether it was.

        It is time sooner where what was found `fails` to foretell the wheels. Such searches too become rarer,
        so that a drive that no limits explain costs no more than the logarithm of its length.
        """
        self._twists.read(position, t)
        count = self._twists.count
        asked = fails and self.search is not None and count >= self._again
        if count < self._next and not asked:
            return False
        self._next = int(np.ceil(GROWTH * count))
        self._again = int(np.ceil(GROWTH_FAILING * count))
        prior = self._settings.filter_settings().prior
        track = self._settings.vehicle.track
        before = self.search if self.search is not None and self.search.found else None
        self.search = _core.find_limits(self._twists.records(), prior, track, _core.LEAST_LIMIT_GAIN, before)
        return True
