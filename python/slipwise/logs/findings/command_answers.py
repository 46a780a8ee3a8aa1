# SPDX-License-Identifier: Apache-2.0
"""Finds commands that are not what moves the robot: echoed as odometry, in a dead band, beyond its limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Inputs

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_MOVES = 0.02  # m/s or rad/s
_SAME = (1e-5, 1e-5)  # m/s or rad/s, and of the value; encoders are not so exact
_LATE = 3  # commands back that an echo may be late
_FEWEST = 5  # changes of the command,
_SAMPLES = 50  # and samples of the wheels while it is not zero
_ALL = 0.95  # of these


class EchoedCommands(Check):
    """Wheel speeds that are the commands."""

    kind, family, spoils = "echoed-commands", "topics", False
    means = (
        "the odometry echoes the command (open loop), or one is a copy of the other; or the drive is perfect"
    )
    shows = "95 % of the wheel speeds are one of the last three commands to five digits"
    cure = "give the encoders; `open_loop: false` of diff_drive_controller; else `--wheel-topic none`"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare each speed of the wheels with the commands before it."""
        counts = [_echoes(run.commands, run.wheels) for run in whole.log.runs]
        same, samples, changes = (
            (sum(column) for column in zip(*counts, strict=True)) if counts else (0, 0, 0)
        )
        if changes < _FEWEST or samples < _SAMPLES or same < _ALL * samples:
            return None
        return self.found(
            f"{100.0 * same / samples:.0f} % of the wheel speeds are the command to five digits: the "
            "odometry echoes it (open loop), or one is a copy of the other, or a simulated drive is perfect",
            "Slip from wheels cannot be learned from an echo: give the encoders (open_loop: false of "
            "diff_drive_controller), or --wheel-topic none.",
            evidence=same / samples,
        )


def _echoes(commands: Inputs | None, wheels: Inputs | None) -> tuple[int, int, int]:
    """Return how many speeds of wheels are commands, of how many while it is not zero, and its changes."""
    if commands is None or wheels is None or not len(commands) or not len(wheels):
        return 0, 0, 0
    given = np.column_stack((commands.v, commands.vy, commands.omega))
    driven = np.column_stack((wheels.v, wheels.vy, wheels.omega))
    newest = np.searchsorted(commands.t, wheels.t, side="right") - 1
    known = newest >= 0
    moves = known & (np.abs(given[np.maximum(newest, 0)]).max(axis=1) > _MOVES)
    same = np.zeros(len(wheels), bool)
    for back in range(_LATE):
        told = given[np.maximum(newest - back, 0)]
        same |= (np.abs(told - driven) <= _SAME[0] + _SAME[1] * np.abs(told)).all(axis=1)
    changes = int((np.diff(given, axis=0) != 0.0).any(axis=1).sum())
    return int((same & moves).sum()), int(moves.sum()), changes
