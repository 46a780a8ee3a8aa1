# SPDX-License-Identifier: Apache-2.0
"""Finds that a robot's watchdog ends commands that are not repeated, and after how long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.findings.watchdog_fit import has_silence, waited
from slipwise.logs.log import Bools, Floats, Inputs, Poses

if TYPE_CHECKING:
    from slipwise.logs.findings.seen import WholeLog

_AGE = 0.1  # s, of the steps in which a command's age is checked
_OLDEST = 6.0  # s after a command
_SLOWEST = 0.05  # m/s or rad/s; less is no command to move
_FEWEST = 10  # pieces of motion in a step of ages
_NEW = 200  # steps, after which it is fitted again
_MOST_GAPS = 100_000  # between commands
_LEFT = 0.35  # of a command at most, where it has ended
_APART = 0.1  # s between poses from which the time is fitted
_PART, _KEPT = 300.0, 6  # s, and how many newest parts with a silence


class CommandStops:
    """What robots do of a command at each age of it, and how far commands are apart: sums of all pieces."""

    def __init__(self) -> None:
        count = int(_OLDEST / _AGE)
        self._given, self._done, self._pieces = np.zeros(count), np.zeros(count), np.zeros(count)
        self._gaps: Floats = np.empty(0)
        self._newest: list[CommandedMotion] = []
        self._steps, self._fitted_at = 0, -_NEW  # between poses
        self._fitted: float | None = None

    def add(self, commands: Inputs, poses: Poses) -> None:
        """Add commands and poses of one run, or of a piece of it, whose first command was the last before."""
        self._gaps = np.concatenate((self._gaps, np.diff(commands.t)[_moves(commands)[:-1]]))[-_MOST_GAPS:]
        every = CommandedMotion.between(commands, poses)
        if every is None:
            return
        held = np.searchsorted(every.t, every.middle, side="right") - 1
        age = every.middle - every.t[held]
        for asked, moved in zip(every.given[held].T, every.moved.T, strict=True):
            kept = (age < _OLDEST) & (np.abs(asked) > _SLOWEST) & np.isfinite(moved)
            step, ones = (age[kept] / _AGE).astype(int), np.ones(int(kept.sum()))
            for total, part in (
                (self._given, np.abs(asked[kept])),
                (self._done, np.sign(asked[kept]) * moved[kept]),
                (self._pieces, ones),
            ):
                total += np.bincount(step, part, len(total))
        self._steps += len(every.start)
        self._keep(CommandedMotion.between(commands, _thinned(poses)))

    def _keep(self, piece: CommandedMotion | None) -> None:
        """Keep the newest parts in which commands are silent, and the last, which may go on."""
        if piece is None:
            return
        before = self._newest[-1] if self._newest else None
        if before is not None and before.t[-1] == piece.t[0] and before.seconds < _PART:
            piece = self._newest.pop().followed_by(piece)
        *whole, last = [*self._newest, *piece.parts(_PART)]
        self._newest = [*[each for each in whole if has_silence(each, _SLOWEST)][-_KEPT:], last]

    def after(self) -> float | None:
        """Return how long after a command the robot stops though no other came [s]; None where it goes on.

        Rare silences of a stream show it as well as commands that are rare throughout.
        """
        known = np.flatnonzero(self._pieces >= _FEWEST)
        if len(known) < 3:
            return None
        left: Floats = np.asarray(self._done[known] / self._given[known], dtype=np.float64)
        top = int(np.argmax(left))
        after = np.flatnonzero(left[top:] < 0.5 * left[top])
        if not len(after) or float(np.median(left[top + after[0] :][-3:])) > _LEFT * left[top]:
            return None
        if self._steps >= self._fitted_at + _NEW:  # what was found stays where nothing newer shows it
            self._fitted, self._fitted_at = waited(self._newest, _SLOWEST) or self._fitted, self._steps
        return self._fitted

    def words(self, unknown_after: float) -> tuple[str, str] | None:
        """Say how rarely commands come and what the robot does between them, and what to do about it.

        Args:
            unknown_after: an input is unknown once it is older than this [s].
        """
        if len(self._gaps) < _FEWEST:
            return None
        usual, stop = float(np.median(self._gaps)), self.after()
        if stop is not None:
            rarely = stop < usual
            return (
                f"commands come every {usual:.2g} s"
                + ("" if rarely else ", with longer silences")
                + f", and the robot stops about {stop:.2g} s after "
                + ("each" if rarely else "the last of them"),
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
        """Say where the robot stops although commands are taken to be held until `unknown_after` [s]."""
        stop = self.after()
        sentence, advice = (stop is not None and self.words(unknown_after)) or ("", "")
        return CommandTimeout.found(sentence, advice, evidence=stop) if sentence else None


class CommandTimeout(Check):
    """A watchdog that ends commands which a log takes to be held."""

    kind, family = "command-timeout", "drive"
    of_input = True
    means = (
        "commands come rarely, or are silent for a while (a released stick): the robot's watchdog stops it "
        "in between, or it holds them for long"
    )
    shows = "how long after a command that is not repeated the robot stops, and how far commands are apart"
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


def _thinned(poses: Poses) -> Poses:
    """Return poses that are about `_APART` from each other."""
    return poses.select(np.unique(np.floor(poses.t / _APART), return_index=True)[1])


def _moves(commands: Inputs) -> Bools:
    return np.asarray(np.abs(commands.v) > _SLOWEST) | (np.abs(commands.omega) > _SLOWEST)
