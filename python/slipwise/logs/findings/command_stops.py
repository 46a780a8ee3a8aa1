# SPDX-License-Identifier: Apache-2.0
"""Finds that a robot's watchdog ends commands that are not repeated, and after how long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.command_timeout import REPEAT
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Bools, Floats, Inputs, Poses
from slipwise.logs.motion_windows import wrapped

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_AGE = 0.1  # s, of the steps in which a command's age is checked
_OLDEST = 6.0  # s after a command
_SLOWEST = 0.05  # m/s or rad/s; less is no command to move
_FEWEST = 10  # pieces of motion in a step of ages
_MOST_GAPS = 100_000  # between commands
_LEFT = 0.35  # of a command at most, where it has ended
_LENGTHS, _DELAYS = np.arange(0.1, 4.01, 0.05), np.arange(0.0, 0.61, 0.05)  # s, tried
_LAGS = np.array((0.03, 0.1, 0.2, 0.3, 0.5, 0.8))  # s, tried


class CommandStops:
    """What robots do of a command at each age of it, and how far commands are apart: sums of all pieces."""

    def __init__(self) -> None:
        count = int(_OLDEST / _AGE)
        self._given, self._done, self._pieces = np.zeros(count), np.zeros(count), np.zeros(count)
        self._gaps: Floats = np.empty(0)

    def add(self, commands: Inputs, poses: Poses) -> None:
        """Add commands and poses of one run, or of a piece of it."""
        for asked, measured, age in _motion(commands, poses):
            kept = (age >= 0.0) & (age < _OLDEST) & (asked > _SLOWEST)
            step, ones = (age[kept] / _AGE).astype(int), np.ones(int(kept.sum()))
            for total, part in (
                (self._given, asked[kept]),
                (self._done, measured[kept]),
                (self._pieces, ones),
            ):
                total += np.bincount(step, part, len(total))
        self._gaps = np.concatenate((self._gaps, np.diff(commands.t)[_moves(commands)[:-1]]))[-_MOST_GAPS:]

    def after(self) -> float | None:
        """Return how long after a command the robot stops though no other came [s]; None where it goes on."""
        known = np.flatnonzero(self._pieces >= _FEWEST)
        if len(known) < 3:
            return None
        left: Floats = np.asarray(self._done[known] / self._given[known], dtype=np.float64)
        top = int(np.argmax(left))
        after = np.flatnonzero(left[top:] < 0.5 * left[top])
        if not len(after) or float(np.median(left[top + after[0] :][-3:])) > _LEFT * left[top]:
            return None
        return _pulse(np.asarray(_AGE * (known + 0.5), dtype=np.float64), left)

    def words(self, unknown_after: float) -> tuple[str, str] | None:
        """Say how rarely commands come and what the robot does between them, and what to do about it.

        Args:
            unknown_after: an input is unknown once it is older than this [s].
        """
        if len(self._gaps) < _FEWEST:
            return None
        usual, stop = float(np.median(self._gaps)), self.after()
        if stop is not None and stop < usual:
            return (
                f"commands come every {usual:.2g} s, and the robot stops about {stop:.2g} s after each",
                f"Give --command-timeout {stop:.2g}: a command ends after so long where it is not repeated.",
            )
        if usual <= unknown_after:
            return None
        advice = (
            f"Raise unknown_after under [segment] to {np.ceil(usual + 1.0):g} where the robot holds a "
            "command until the next; where it stops by itself, give --command-timeout."
        )
        return f"commands come every {usual:.2g} s and count as unknown after {unknown_after:g} s", advice

    def found(self, unknown_after: float) -> Finding | None:
        """Say where the robot stops between commands that are taken to be held until `unknown_after` [s]."""
        stop = self.after()
        if stop is None or stop + REPEAT > unknown_after:
            return None
        sentence, advice = self.words(unknown_after) or ("", "")
        return CommandTimeout.found(sentence, advice, evidence=stop) if sentence else None


class CommandTimeout(Check):
    """A watchdog that ends commands which a log takes to be held."""

    kind, family = "command-timeout", "drive"
    of_input = True
    means = "commands come rarely: the robot's watchdog stops it in between, or it holds them for long"
    shows = "how long after a command the robot stops, and how far commands are apart"
    cure = "`--command-timeout S`; on the robot, send commands more often or raise `cmd_vel_timeout`"

    def look_at(self, whole: WholeLog) -> Finding | None:
        """Look at commands and poses of a log; live they are added as they come."""
        if whole.input_name != "command":
            return None
        runs = whole.log.runs
        pairs = [(run.commands, run.poses) for run in runs if run.commands is not None and len(run.poses)]
        stops = stops_of(pair for pair in pairs if len(pair[0]))
        spoilt = stops.found(whole.unknown_after)
        words = None if spoilt else stops.words(whole.unknown_after)
        return spoilt if words is None else self.found(*words, evidence=stops.after(), spoils=False)


def stops_of(pairs: Iterable[tuple[Inputs, Poses]]) -> CommandStops:
    """Return the sums of commands and poses of each run."""
    stops = CommandStops()
    for commands, poses in pairs:
        stops.add(commands, poses)
    return stops


def _pulse(age: Floats, left: Floats) -> float:
    """Return how long a pulse [s] is whose answer by a delay and a lag is what is `left` [N] at ages [N]."""
    seconds, delay, lag = np.meshgrid(_LENGTHS, _DELAYS, _LAGS, indexing="ij")
    since = age - delay[..., None]
    rise = 1.0 - np.exp(-np.maximum(since, 0.0) / lag[..., None])
    fall = 1.0 - np.exp(-np.maximum(since - seconds[..., None], 0.0) / lag[..., None])
    answer = rise - fall
    size = np.sum(answer * answer, axis=-1)
    fit = np.where(size > 0.0, np.sum(answer * left, axis=-1), 0.0) ** 2 / np.where(size > 0.0, size, 1.0)
    return float(seconds.ravel()[np.argmax(fit)])


def _motion(commands: Inputs, poses: Poses) -> list[tuple[Floats, Floats, Floats]]:
    """Return what was asked, measured along it, and the command's age [s], of speeds and of yaw rates."""
    if len(poses) < 2 or not len(commands):
        return []
    steps = np.diff(poses.t)
    middle = poses.t[:-1] + 0.5 * steps
    held = np.searchsorted(commands.t, middle, side="right") - 1
    good = (held >= 0) & (steps < _OLDEST) & (poses.frame[1:] == poses.frame[:-1])
    held, middle, steps = held[good], middle[good], steps[good]
    yaw = poses.yaw[:-1][good]
    along = np.cos(yaw) * np.diff(poses.x)[good] + np.sin(yaw) * np.diff(poses.y)[good]
    turn = wrapped(np.diff(poses.yaw))[good]
    age = middle - commands.t[held]
    found = []
    for asked, moved in ((commands.v[held], along / steps), (commands.omega[held], turn / steps)):
        found.append((np.abs(asked), np.sign(asked) * moved, age))
    return found if not poses.course else found[:1]


def _moves(commands: Inputs) -> Bools:
    return np.asarray(np.abs(commands.v) > _SLOWEST) | (np.abs(commands.omega) > _SLOWEST)
