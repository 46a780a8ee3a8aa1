# SPDX-License-Identifier: Apache-2.0
"""A robot's watchdog ends commands that are not repeated: live it is found, and followed, as in a log."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipwise.live.samples import Command, Pose, Stamped
from slipwise.logs.command_timeout import end_stamps, held_stamps
from slipwise.logs.findings.command_stops import CommandStops
from slipwise.logs.findings.finding import Finding
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, Poses

WAIT = 1.0  # s; a command may come so much later than a pose of its stamp
_AT_ONCE = 200  # poses
SAID_EVERY = 60.0  # s between looks
_MOST = 20_000  # that wait where no command comes
COMES_WITHIN = 0.1  # s; a command may come so much later than a sample of another stream with its stamp


class LiveCommandStops:
    """Adds commands and poses with headings piece by piece.

    Args:
        unknown_after: an input is unknown once it is older than this [s].
        given: how long after a command that is not repeated it is said to end [s]; None: it is held.
    """

    def __init__(self, unknown_after: float, given: float | None = None) -> None:
        self._unknown_after, self._stops = unknown_after, CommandStops(given)
        self._commands: list[tuple[float, float, float, float]] = []
        self._poses: list[tuple[float, float, float, float, float]] = []

    def take_command(self, command: Command) -> None:
        """Take a command; one that is not later than the last says nothing."""
        if command.ended and self._stops.given is not None:
            return
        row = (command.t, command.v, command.vy, command.omega)
        if all(map(math.isfinite, row)) and (not self._commands or row[0] > self._commands[-1][0]):
            self._commands.append(row)

    def take_pose(self, pose: Pose, frame: int) -> None:
        """Take a pose in the frame of a number."""
        row = (pose.t, pose.x, pose.y, pose.yaw, float(frame))
        if all(map(math.isfinite, row)) and (not self._poses or row[0] > self._poses[-1][0]):
            self._poses.append(row)
        if len(self._poses) >= _AT_ONCE and self._poses[-_AT_ONCE][0] < self._poses[-1][0] - WAIT:
            self._add()

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._commands.clear()
        self._poses.clear()

    def words(self) -> str:
        """Say how rarely commands come and what to do about it; empty where they come often enough."""
        return " ".join(f"{each.rstrip('.')}." for each in self._stops.words(self._unknown_after) or ())

    def found(self) -> tuple[Finding, ...]:
        """Say where the robot stops between commands that are taken to be held."""
        self._add()
        found = self._stops.found(self._unknown_after)
        return () if found is None else (found,)

    def _add(self) -> None:
        """Add all until `WAIT` before the newest pose; the last pose and the last two commands stay."""
        if len(self._poses) < 2 or not self._commands:
            del self._poses[:-_MOST]
            return
        until = self._poses[-1][0] - WAIT
        ready = [row for row in self._poses if row[0] <= until]
        known = [row for row in self._commands if row[0] <= until]
        if len(ready) < 2 or not known:
            return
        commands, poses = (np.ascontiguousarray(np.array(rows).T) for rows in (known, ready))
        t, x, y, yaw, frame = poses
        self._stops.add(Inputs(*commands), Poses(t, x, y, yaw, frame.astype(np.int64)))
        self._poses = self._poses[len(ready) - 1 :]
        self._commands = self._commands[len(known) - 1 :]


class CommandEnds:
    """Gives what a log of the same drive has after each command that is not repeated, with its stamps.

    It is said again while the watchdog waits for longer than inputs are known; then zeros come.

    Args:
        seconds: after which a command ends; None: it is held.
        unknown_after: an input is unknown once it is older than this [s].
    """

    def __init__(self, seconds: float | None, unknown_after: float = UNKNOWN_AFTER) -> None:
        self._seconds, self._unknown_after = seconds, unknown_after
        self._given: Command | None = None  # the last one
        self._last = -math.inf  # s, stamp of what was given after it

    def before(self, sample: Stamped) -> list[Command]:
        """Return what is due before a sample."""
        seconds, t = self._seconds, sample.t
        if seconds is None or not math.isfinite(t):
            return []
        due: list[Command] = []
        if self._given is not None:
            until = t if isinstance(sample, Command) else t - COMES_WITHIN
            given = self._given
            held = held_stamps(given.t, seconds, until, self._unknown_after)
            due = [replace(given, t=at, ended=True) for at in held]
            due += [Command(at, 0.0, 0.0, ended=True) for at in end_stamps(given.t, seconds, until)]
            due = [each for each in due if each.t > self._last]
            self._last = due[-1].t if due else self._last
        if isinstance(sample, Command):
            self._given = sample
        return due

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._given, self._last = None, -math.inf
