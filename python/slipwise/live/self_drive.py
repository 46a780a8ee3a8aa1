# SPDX-License-Identifier: Apache-2.0
"""Drives a designed sequence of moves: counts down, commands at a rate, and stops at once where it must."""

from __future__ import annotations

import contextlib
import math
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from slipwise.excitation.moves import Move
from slipwise.live.drive_guard import DriveGuard
from slipwise.live.drive_link import DriveLink

LOOK = 0.05  # s between two looks at what is missing
SAY_EVERY = 5.0  # s between two times that it is said
INTERRUPTED = "it was interrupted"


@dataclass(frozen=True)
class DrivePlan:
    """What is driven, and how it is commanded."""

    moves: Sequence[Move]
    lead: float = 1.0  # s of commands to stand before the first move
    rate: float = 20.0  # Hz
    countdown: float = 5.0  # s, for which all must be well before the robot moves
    stand: float = 0.5  # s of commands to stand after the drive
    late: float = 0.25  # s that a command may be late; beyond it the drive would be another one

    @property
    def seconds(self) -> float:
        """How long the drive takes [s]."""
        return self.lead + sum(move.seconds for move in self.moves)

    def command(self, t: float) -> tuple[float, float, int]:
        """Return speed [m/s], yaw rate [rad/s] and the number of the move, from 1, at a time [s]."""
        begin = self.lead
        for number, move in enumerate(self.moves, start=1):
            if t < begin:
                break
            if t < begin + move.seconds:
                return (move.v, move.omega, number) if t < begin + move.hold else (0.0, 0.0, number)
            begin += move.seconds
        return 0.0, 0.0, 0


@dataclass(frozen=True)
class DriveReport:
    """What came of the drive."""

    why: str  # it ended before its end; empty: it is complete
    moves: int  # that were begun
    seconds: float  # from the first command on
    commands: int
    poses: int
    room_left: float  # m, the least between base_link and the bounds
    stopped_after: float  # s, from what made it stop to the command to stand; NaN where nothing did


class SelfDrive:
    """Commands a robot in the thread that calls `run`.

    Whatever happens, the last commands are to stand: at the end, on trouble, on `stop`, on any exception.

    Args:
        link: carries commands.
        guard: says when to stop; it hears the link.
        plan: what is driven.
        say: is told what is waited for, and the countdown.
    """

    def __init__(
        self, link: DriveLink, guard: DriveGuard, plan: DrivePlan, *, say: Callable[[str], None]
    ) -> None:
        self._link, self._guard, self._plan, self._say = link, guard, plan, say
        self._stopped = threading.Event()
        self._began = math.nan  # s
        self._sent = self._moves = 0
        self._stood = math.nan  # s, of the first command to stand at the end

    def stop(self) -> None:
        """End the drive now; may be called from any thread, or a signal."""
        self._stopped.set()
        self._guard.wake.set()

    def run(self) -> DriveReport:
        """Wait until all is well, count down, drive, and stand; return what came of it.

        Raises:
            SlipwiseError: the robot's topics do not fit.
        """
        self._link.hear(self._guard)
        why = INTERRUPTED
        try:
            while not self._stopped.is_set():
                if self._wait() and self._count_down():
                    why = self._drive()
                    break
        finally:
            self._stand()
        caused = self._guard.caused_at
        return DriveReport(
            why,
            self._moves,
            0.0 if math.isnan(self._began) else self._stood - self._began,
            self._sent,
            self._guard.poses,
            self._guard.room_left,
            self._stood - caused,
        )

    def _wait(self) -> bool:
        """Wait until nothing is missing; return whether that came before `stop`."""
        said, said_at = "", -math.inf
        while not self._stopped.is_set():
            missing = self._link.missing() or self._guard.not_ready()
            if not missing:
                return True
            now = time.monotonic()
            if missing != said or now > said_at + SAY_EVERY:
                said, said_at = missing, now
                self._say(f"waiting for {missing}")
            self._stopped.wait(LOOK)
        return False

    def _count_down(self) -> bool:
        """Count down; return whether all was well until its end, and the robot stood."""
        self._guard.stand()
        end, said = time.monotonic() + self._plan.countdown, 0
        while (left := end - time.monotonic()) > 0.0:
            if math.ceil(left) != said:
                said = math.ceil(left)
                self._say(f"the robot drives in {said} s")
            if self._stopped.wait(min(LOOK, left)):
                return False
            if self._guard.not_ready():
                return False
            if not self._guard.stands():
                self._say("the robot moves: it must stand before the drive")
                return False
        return True

    def _drive(self) -> str:
        """Command the moves; return why it ended before its end."""
        plan, guard = self._plan, self._guard
        guard.begin()
        self._began = time.monotonic()
        number, period = 0, 1.0 / plan.rate
        while True:
            now = time.monotonic() - self._began
            if self._stopped.is_set():
                return INTERRUPTED
            if trouble := guard.trouble():
                return trouble
            if now - number * period > plan.late:
                return f"this computer is busy: a command came {now - number * period:.2f} s late"
            if now >= plan.seconds:
                return ""
            v, omega, move = plan.command(now)
            self._moves = max(self._moves, move)
            self._send(v, omega)
            number += 1
            guard.wake.wait(max(0.0, self._began + number * period - time.monotonic()))

    def _send(self, v: float, omega: float) -> None:
        """Command, never faster than the limits."""
        bounds = self._guard.bounds
        if not (abs(v) <= bounds.speed * 1.001 and abs(omega) <= bounds.yaw_rate * 1.001):
            raise ValueError(f"a command of {v} m/s, {omega} rad/s is beyond the limits")
        self._link.send(v, omega)
        self._sent += 1

    def _stand(self) -> None:
        """Command to stand for a while, where the robot was commanded at all; a failure is tried again."""
        if math.isnan(self._began):
            return
        end = time.monotonic() + self._plan.stand
        while True:
            with contextlib.suppress(Exception):
                self._link.send(0.0, 0.0)
                if math.isnan(self._stood):
                    self._stood = time.monotonic()
            if time.monotonic() >= end:
                break
            time.sleep(1.0 / self._plan.rate)
        if math.isnan(self._stood):
            self._stood = time.monotonic()
            self._say("THE COMMAND TO STAND COULD NOT BE SENT: stop the robot by hand")
