# SPDX-License-Identifier: Apache-2.0
"""A robot's watchdog ends commands that are not repeated: so they end in a log, and it is noticed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from slipwise.logs.contradiction import Contradiction
from slipwise.logs.log import Bools, Floats, Inputs, Log, Poses
from slipwise.logs.motion_windows import wrapped

REPEAT = 0.2  # s between the zeros that stand for an ended command,
_LONGEST = 600.0  # s of them after each command
_AGE = 0.1  # s, of the steps in which a command's age is checked
_OLDEST = 6.0  # s after a command
_SLOWEST = 0.05  # m/s or rad/s; less is no command to move
_FEWEST = 10  # pieces of motion in a step of ages
_MOST_GAPS = 100_000  # between commands
_LEFT = 0.35  # of a command at most, where it has ended
_LENGTHS, _DELAYS = np.arange(0.1, 4.01, 0.05), np.arange(0.0, 0.61, 0.05)  # s, tried
_LAGS = np.array((0.03, 0.1, 0.2, 0.3, 0.5, 0.8))  # s, tried


def end_stamps(given: float, seconds: float, until: float) -> list[float]:
    """Return the stamps [s] before `until` at which zeros stand for a command that was `given` and ended."""
    first = given + seconds
    count = int(np.ceil((min(until, given + _LONGEST) - first) / REPEAT))
    return [first + REPEAT * k for k in range(max(count, 0)) if first + REPEAT * k < until]


def with_ended_commands(log: Log, seconds: float | None) -> Log:
    """Return the log with commands that end `seconds` after each that is not repeated, which is noted."""
    if seconds is None:
        return log
    runs, count = [], 0
    for run in log.runs:
        if run.commands is not None:
            commands, ended = _ended(run.commands, seconds, run.span[1])
            run, count = replace(run, commands=commands), count + ended
        runs.append(run)
    note = f"commands end {seconds:g} s after each, as given: {count} were not repeated in that time"
    return replace(log, runs=tuple(runs), notes=(*log.notes, note))


def _ended(commands: Inputs, seconds: float, last: float) -> tuple[Inputs, int]:
    following = np.append(commands.t[1:], max(last, float(commands.t[-1])))
    zeros = [
        stamps
        for given, after in zip(commands.t.tolist(), following.tolist(), strict=True)
        if (stamps := end_stamps(given, seconds, after))
    ]
    added = np.array([stamp for stamps in zeros for stamp in stamps])
    t = np.concatenate((commands.t, added))
    order = np.argsort(t, kind="stable")
    none = np.zeros(len(added))
    v, vy, omega = (np.concatenate((c, none))[order] for c in (commands.v, commands.vy, commands.omega))
    return replace(commands, t=t[order], v=v, vy=vy, omega=omega), len(zeros)


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

    def contradiction(self, unknown_after: float) -> Contradiction | None:
        """Say where the robot stops between commands that are taken to be held until `unknown_after` [s]."""
        stop = self.after()
        if stop is None or stop + REPEAT > unknown_after:
            return None
        sentence, advice = self.words(unknown_after) or ("", "")
        return Contradiction("command-timeout", sentence, (advice,)) if sentence else None


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
