# SPDX-License-Identifier: Apache-2.0
"""Finds that a gyro beside positions does not turn as the inputs do."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.gyro import COLUMN, measured_rates, otherwise, turns_otherwise
from slipwise.logs.motion_windows import run_name

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import Seen, WholeLog


class GyroTurnsOtherwise(Check):
    """A gyro, learned from or left out, that does not turn as the inputs do."""

    kind, family, reserves = "gyro-turns-otherwise", "signs and units", True
    means = "a gyro in degrees, clockwise, or with its z axis down"
    shows = "it turns less than 0.05 or more than 5 times as much as the inputs, over 15 s of turns"
    cure = f"`{COLUMN}` in rad/s, positive counter-clockwise seen from above"

    def look(self, seen: Seen) -> Finding | None:
        """Look at one that is learned from."""
        odd = [run_name(seen.runs, row[0]) for row in seen.evidence.gyro_turns if otherwise(row)]
        if not (seen.gyro and odd):
            return None
        return self._said("the gyro does not turn as the inputs do", odd[0], spoils=True)

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at those that are left out."""
        odd = [run.name for run in whole.log.runs if turns_otherwise(run, measured_rates(run))]
        what = "the gyro does not turn as the inputs do and is left out"
        return self._said(what, odd[0], spoils=False) if odd else None

    def _said(self, what: str, run: str, *, spoils: bool) -> Finding:
        advice = f"Give {COLUMN} in rad/s, positive counter-clockwise seen from above."
        return self.found(f"{what} (run {run})", advice, spoils=spoils)
