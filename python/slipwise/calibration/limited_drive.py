# SPDX-License-Identifier: Apache-2.0
"""The commands of every run behind the limits of the drive."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from slipwise import _core


@dataclass(frozen=True, eq=False)
class LimitedDrive:
    """Runs and the limits in front of their drive; what comes of a command depends on no later one."""

    commands: tuple[_core.InputTrack, ...]  # of each run
    limits: _core.CommandLimits

    def track(self, position: int) -> _core.InputTrack:
        """Return the inputs of the run at `position`, limited."""
        known = self._tracks
        if position not in known:
            known[position] = _core.limited_track(self.commands[position], self.limits, _core.RAMP_PIECE)
        return known[position]

    @cached_property
    def _tracks(self) -> dict[int, _core.InputTrack]:
        return {}
