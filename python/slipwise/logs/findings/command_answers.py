# SPDX-License-Identifier: Apache-2.0
"""Finds commands that are not what moves the robot: echoed as odometry, or in a dead band."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats, Inputs

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_MOVES = 0.02  # m/s or rad/s
_SAME = (1e-5, 1e-5)  # m/s or rad/s, and of the value; encoders are not so exact
_LATE = 3  # commands back that an echo may be late
_FEWEST = 5  # changes of the command,
_SAMPLES = 50  # and samples of the wheels while it is not zero
_ALL = 0.95  # of these
_SETTLED, _HELD = 0.8, 0.7  # s until the wheels have answered, and for how long they are then looked at
_STILL = 0.05  # of the command
_SMALL = 4  # commands without an answer,
_FEW = 0.05  # and part of the larger ones that have none either


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


class DeadBand(Check):
    """Commands that are too small to turn a wheel."""

    kind, family, spoils = "dead-band", "drive", False
    means = "commands below a size turn no wheel: a dead band of the drive larger than what the planner sends"
    shows = (
        "of commands held for 1.5 s, 95 % below it turn the wheels by less than 5 % of it, and 95 % above do"
    )
    cure = "`min_speed_theta`, `min_speed_xy` of the planner; the least output of the motor driver"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Compare held commands with what the wheels did, for speed and yaw rate."""
        if whole.input_name != "command":
            return None
        runs = whole.log.runs
        for unit, what, column in (("m/s", "speed", "v"), ("rad/s", "yaw rate", "omega")):
            pairs = [_held_answers(run.commands, run.wheels, column) for run in runs]
            asked, done = np.concatenate([np.empty((2, 0)), *pairs], axis=1)
            order = np.argsort(asked)
            asked, done = asked[order], done[order]
            still = done < _STILL * asked
            moving_below = np.cumsum(~still) / np.arange(1, len(still) + 1)
            below = int(np.flatnonzero(moving_below <= _FEW).max(initial=-1)) + 1
            if not _SMALL <= below < len(asked) or still[below:].mean() > _FEW:
                continue
            band = float(asked[below])
            return self.found(
                f"{int(still[:below].sum())} of {below} commands of a {what} below {band:.2g} {unit} turn no "
                "wheel, and nearly all above do: the drive has a dead band",
                f"Send no {what} below {band:.2g} {unit} but 0, or raise the driver's least output.",
                evidence=band,
            )
        return None


def _held_answers(commands: Inputs | None, wheels: Inputs | None, column: str) -> Floats:
    """Return the sizes of commands that were held, and of what the wheels then did in their sense, [2, N]."""
    if commands is None or wheels is None or len(commands) < 2 or not len(wheels):
        return np.empty((2, 0))
    given = np.column_stack((commands.v, commands.vy, commands.omega))
    new = np.flatnonzero(np.concatenate(([True], (np.diff(given, axis=0) != 0.0).any(axis=1))))
    begin, end = commands.t[new] + _SETTLED, np.append(commands.t[new[1:]], commands.t[-1])
    values, found = getattr(wheels, column), []
    for asked, first, last in zip(getattr(commands, column)[new], begin, end, strict=True):
        if abs(asked) > 0.5 * _MOVES and last - first > _HELD:
            own = values[np.searchsorted(wheels.t, first) : np.searchsorted(wheels.t, last)]
            if len(own) > 2:
                found.append((abs(asked), float(np.median(own)) * np.sign(asked)))
    return np.array(found).T if found else np.empty((2, 0))
