# SPDX-License-Identifier: Apache-2.0
"""Commands beside what the robot did between poses, as it was measured."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from slipwise.logs.log import Floats, Inputs, Poses
from slipwise.logs.motion_windows import wrapped

_LONGEST = 6.0  # s between two poses


@dataclass(frozen=True)
class CommandedMotion:
    """Commands of one recording, and what the robot did between poses."""

    t: Floats  # [N] s, stamps of commands
    given: Floats  # [N, 2] m/s and rad/s
    start: Floats  # [K] s, of steps between two poses
    stop: Floats  # [K] s
    moved: Floats  # [K, 2] m/s and rad/s; NaN where only courses were measured

    @classmethod
    def between(cls, commands: Inputs, poses: Poses) -> CommandedMotion | None:
        """Return what was asked and done between poses; None where nothing was."""
        if len(poses) < 2 or not len(commands):
            return None
        steps = np.diff(poses.t)
        middle = poses.t[:-1] + 0.5 * steps
        good = (middle >= commands.t[0]) & (steps < _LONGEST) & (poses.frame[1:] == poses.frame[:-1])
        if not good.any():
            return None
        yaw = poses.yaw[:-1]
        along = (np.cos(yaw) * np.diff(poses.x) + np.sin(yaw) * np.diff(poses.y)) / steps
        turn = np.full(len(steps), np.nan) if poses.course else wrapped(np.diff(poses.yaw)) / steps
        given = np.column_stack((commands.v, commands.omega))
        moved = np.column_stack((along, turn))
        return cls(commands.t, given, poses.t[:-1][good], poses.t[1:][good], moved[good])

    @property
    def middle(self) -> Floats:
        """Middle of each step [s], [K]."""
        return 0.5 * (self.start + self.stop)

    def parts(self, seconds: float) -> list[CommandedMotion]:
        """Return parts of so many seconds, each with the commands from the one in force at its start on."""
        number = np.floor((self.start - self.start[0]) / seconds)
        first = [*np.flatnonzero(np.diff(number, prepend=-1.0)).tolist(), len(self.start)]
        found = []
        for begin, end in itertools.pairwise(first):
            held = int(np.searchsorted(self.t, self.start[begin], side="right")) - 1
            until = int(np.searchsorted(self.t, self.stop[end - 1], side="right"))
            commands = slice(max(held, 0), until if end < len(self.start) else None)
            steps = slice(begin, end)
            columns = (self.start[steps], self.stop[steps], self.moved[steps])
            found.append(CommandedMotion(self.t[commands], self.given[commands], *columns))
        return found

    def followed_by(self, after: CommandedMotion) -> CommandedMotion:
        """Return one piece of two, whose last and first command are the same."""
        pairs = (
            (self.t, after.t[1:]),
            (self.given, after.given[1:]),
            (self.start, after.start),
            (self.stop, after.stop),
            (self.moved, after.moved),
        )
        return CommandedMotion(*map(np.concatenate, pairs))

    @property
    def seconds(self) -> float:
        """From its first pose to its last [s]."""
        return float(self.stop[-1] - self.start[0])

    def gaps(self) -> Floats:
        """Return how long each command was not followed by another, or the poses went on [s], [N]."""
        return np.diff(self.t, append=max(float(self.t[-1]), float(self.stop[-1])))
