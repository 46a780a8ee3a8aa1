# SPDX-License-Identifier: Apache-2.0
"""Finds commands that are not what moves the robot: echoed as odometry, in a dead band, or overridden."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.held import HeldSum, rests
from slipwise.logs.log import Floats, Inputs, Run

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
_NONE = 1e-3  # m/s or rad/s, a command to stand
_STOPPED = 1.5  # s after which a robot that was told to stand does
_DRIVES = 0.1  # m/s of the wheels, turns by an arm of
_ARM = 0.3  # m
_OVERRIDDEN = 5.0  # s of driving against one command to stand


class EchoedCommands(Check):
    """Wheel speeds that are the commands."""

    kind, family, spoils = "echoed-commands", "topics", False
    means = "the odometry echoes the command (open loop), or one is a copy of the other"
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
    given = commands.twists()
    driven = wheels.twists()
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
    of_input = True
    means = "commands below a size turn no wheel: a dead band of the drive larger than what the planner sends"
    shows = "of commands held for 1.5 s, 95 % below it turn the wheels by less than 5 %, and 95 % above do"
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
    given = commands.twists()
    new = np.flatnonzero(np.concatenate(([True], (np.diff(given, axis=0) != 0.0).any(axis=1))))
    begin, end = commands.t[new] + _SETTLED, np.append(commands.t[new[1:]], commands.t[-1])
    values, found = getattr(wheels, column), []
    for asked, first, last in zip(getattr(commands, column)[new], begin, end, strict=True):
        if abs(asked) > 0.5 * _MOVES and last - first > _HELD:
            own = values[np.searchsorted(wheels.t, first) : np.searchsorted(wheels.t, last)]
            if len(own) > 2:
                found.append((abs(asked), float(np.median(own)) * np.sign(asked)))
    return np.array(found).T if found else np.empty((2, 0))


class Overridden(Check):
    """Wheels that drive while the commands say stand."""

    kind, family, spoils = "overridden", "drive", False
    of_input = True
    means = "somebody else drives: an operator's override, or other inputs of twist_mux"
    shows = "for 5 s and more the wheels drive, 1.5 s after a command to stand that is repeated all the time"
    cure = "record what the multiplexer gives out; `[live] override_topic`; `--input wheel`"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look what the wheels do while the command is zero."""
        if whole.input_name != "command":
            return None
        stretches = [each for run in whole.log.runs for each in _driven_at_rest(run, whole.unknown_after)]
        found = [each for each in stretches if each[0] > _OVERRIDDEN]
        if not found:
            return None
        longest, place = max(found)
        total = sum(seconds for seconds, _ in found)
        return self.found(
            f"the wheels drive for {total:.0f} s in which the commands say stand, for {longest:.0f} s from "
            f"{place}: somebody else drives (an operator, another input of a multiplexer)",
            "Record what the multiplexer gives out, not one of its inputs; name the operator's topic as "
            "[live] override_topic; or learn from the wheels (--input wheel).",
            evidence=total,
        )


def _driven_at_rest(run: Run, unknown_after: float) -> list[tuple[float, str]]:
    """Return for how long [s] the wheels drove against each command to stand, and from where on."""
    c, w = run.commands, run.wheels
    if c is None or w is None or not len(c) or not len(w):
        return []
    first, last = rests(c, _NONE, unknown_after)
    ends = np.minimum(np.append(c.t[1:], np.inf)[last], c.t[last] + unknown_after)
    begins = np.minimum(c.t[first] + _STOPPED, ends)
    drives = np.hypot(w.v, w.vy) + _ARM * np.abs(w.omega) > _DRIVES
    seconds = HeldSum.of(w, drives.astype(float), unknown_after).between(begins, ends)
    return [(s, run.place(t)) for s, t in zip(seconds.tolist(), begins.tolist(), strict=True)]
