# SPDX-License-Identifier: Apache-2.0
"""Commands that the robot's watchdog ends where they are not repeated: zeros stand for them."""

from __future__ import annotations

import math

from slipwise.live.samples import Command, Stamped
from slipwise.logs.command_timeout import end_stamps

WAIT = 0.1  # s; a command may come so much later than a sample of another stream with its stamp


class CommandEnds:
    """Gives zeros after each command that is not repeated, with the stamps that a log of the same drive has.

    Args:
        seconds: after which a command ends; None: it is held.
    """

    def __init__(self, seconds: float | None) -> None:
        self._seconds = seconds
        self._given: float | None = None  # s, stamp of the last command
        self._ended = -math.inf  # s, stamp of the last zero

    def before(self, sample: Stamped) -> list[Command]:
        """Return the zeros that are due before a sample."""
        seconds, t = self._seconds, sample.t
        if seconds is None or not math.isfinite(t):
            return []
        due: list[Command] = []
        if self._given is not None:
            until = t if isinstance(sample, Command) else t - WAIT
            due = [
                Command(at, 0.0, 0.0) for at in end_stamps(self._given, seconds, until) if at > self._ended
            ]
            self._ended = due[-1].t if due else self._ended
        if isinstance(sample, Command):
            self._given = t
        return due

    def restart(self) -> None:
        """Another recording begins, or the clock was set."""
        self._given, self._ended = None, -math.inf
