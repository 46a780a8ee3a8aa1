# SPDX-License-Identifier: Apache-2.0
"""Finds that a robot's watchdog ends commands that are not repeated, and after how long."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from slipwise.logs.command_timeout import ends_after
from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Bools, Floats, Inputs, Ints, Poses

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
#: Tried [s]; the last is no watchdog.
_WAITS = np.concatenate((np.arange(0.1, 1.5, 0.05), np.arange(1.5, 4.01, 0.1), [np.inf]))
_DELAYS = np.arange(0.0, 0.61, 0.05)  # s, tried
_LAGS = np.array((0.03, 0.1, 0.2, 0.3, 0.5, 0.8))  # s, tried
_STEP = 0.025  # s, of the grid
_SETTLED = 2.0  # s after the start of a piece; how the robot moved before it is not known
_SILENCE = 0.3  # s without a command
_BEFORE, _AFTER = 1.0, 2.5  # s around a silence; a robot that starts again shows its delay
_ENOUGH = 3  # silences that are longer than the watchdog waits
_ERRORS_LEFT = 0.6  # of the squared errors with what is said of a watchdog, those with another are less
_ALIKE = 0.1  # of what the best takes away of them at most, one that holds its commands leaves


class CommandStops:
    """What robots do of a command at each age of it, and how far commands are apart: sums of all pieces.

    Args:
        given: how long after a command that is not repeated it is said to end [s]; None: it is held.
    """

    def __init__(self, given: float | None = None) -> None:
        self.given, self._held = given, False  # whether commands are known until a watchdog ends them
        count = int(_OLDEST / _AGE)
        self._given, self._done, self._pieces = np.zeros(count), np.zeros(count), np.zeros(count)
        self._gaps: Floats = np.empty(0)
        self._newest: list[CommandedMotion] = []
        self._steps, self._fitted_at = 0, -_NEW  # between poses
        self._fitted: float | None = None

    def add(self, commands: Inputs, poses: Poses) -> None:
        """Add commands and poses of one run, or of a piece of it, whose first command was the last before."""
        self._held, commands = self._held or bool(commands.ends.any()), commands.sent
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
        return self._fit()

    def _fit(self) -> float | None:
        if self._steps >= self._fitted_at + _NEW:  # what was found stays where nothing newer shows it
            found = waited(self._newest, _SLOWEST, self.given)
            self._fitted, self._fitted_at = found or self._fitted, self._steps
        return self._fitted

    def words(self, unknown_after: float) -> tuple[str, str] | None:
        """Say how rarely commands come and what the robot does between them, and what to do about it.

        Args:
            unknown_after: an input is unknown once it is older than this [s].
        """
        if len(self._gaps) < _FEWEST:
            return None
        if self.given is not None:
            return self._otherwise(self.given)
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
        if usual <= unknown_after or self._held:
            return None
        advice = (
            f"Raise unknown_after under [segment] to {np.ceil(usual + 1.0):g} where the robot holds a "
            "command until the next; where it stops by itself, give --command-timeout."
        )
        return f"commands come every {usual:.2g} s and count as unknown after {unknown_after:g} s", advice

    def _otherwise(self, given: float) -> tuple[str, str] | None:
        """Say where the robot ends commands otherwise than is said."""
        stop = self._fit()
        if stop is None:
            return None
        said = f"commands are said to end {given:.2g} s after each that is not repeated, and the robot "
        if np.isinf(stop):
            return f"{said}goes on until the next", "Leave --command-timeout away."
        return f"{said}stops about {stop:.2g} s after each", f"Give --command-timeout {stop:.2g}."

    def found(self, unknown_after: float) -> Finding | None:
        """Say where the robot stops although commands are taken to be held until `unknown_after` [s]."""
        stop = self.after() if self.given is None else self._fit()
        sentence, advice = (stop is not None and self.words(unknown_after)) or ("", "")
        evidence = self.given if stop == np.inf else stop
        return CommandTimeout.found(sentence, advice, evidence=evidence) if sentence else None


class CommandTimeout(Check):
    """A watchdog that ends commands which a log takes to be held."""

    kind, family = "command-timeout", "drive"
    of_input = True
    means = (
        "commands come rarely, or end with a released stick: the robot's watchdog stops it, or it holds "
        "them; or its timeout is not the one given"
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
        return spoilt if words is None else self.found(*words, spoils=False)


def stops_of(pairs: Iterable[tuple[Inputs, Poses]]) -> CommandStops:
    """Return the sums of commands and poses of each run."""
    every = list(pairs)
    given = [seconds for commands, _ in every if (seconds := ends_after(commands)) is not None]
    stops = CommandStops(given[0] if given else None)
    for commands, poses in every:
        stops.add(commands, poses)
    return stops


def _thinned(poses: Poses) -> Poses:
    """Return poses that are about `_APART` from each other."""
    return poses.select(np.unique(np.floor(poses.t / _APART), return_index=True)[1])


def _moves(commands: Inputs) -> Bools:
    return np.asarray(np.abs(commands.v) > _SLOWEST) | (np.abs(commands.omega) > _SLOWEST)


def waited(pieces: Sequence[CommandedMotion], slowest: float, given: float | None = None) -> float | None:
    """Return how long [s] a command lasts that is not repeated; None where too little shows that.

    Args:
        pieces: of one robot.
        slowest: commands up to this [m/s or rad/s] are none to move.
        given: how long it is said to last [s]; None: until the next.
    """
    errors, gaps = np.zeros(len(_WAITS)), [np.empty(0)]
    for channel in (0, 1):
        moved, products, squares = 0.0, *np.zeros((2, len(_DELAYS), len(_WAITS), len(_LAGS)))
        for piece in pieces:
            moves = np.abs(piece.given[:, channel]) > slowest
            near = _near(piece, moves) & np.isfinite(piece.moved[:, channel])
            if not near.any():
                continue
            done = piece.moved[near, channel]
            moved += float(done @ done)
            for k, answers in enumerate(_answers(piece, channel, near)):  # [K, waits, lags]
                products[k] += np.einsum("k,kwl->wl", done, answers)
                squares[k] += np.einsum("kwl,kwl->wl", answers, answers)
            gaps.append(piece.gaps()[moves])
        explained = np.maximum(products, 0.0) ** 2 / np.where(squares > 0.0, squares, 1.0)
        errors += moved - explained.max(axis=(0, 2))
    said = len(_WAITS) - 1 if given is None else int(np.argmin(np.abs(_WAITS - given)))
    best = int(np.argmin(errors))
    if errors[-1] - errors[best] < _ALIKE * (errors[said] - errors[best]):
        best = len(_WAITS) - 1
    silences = int(np.sum(np.concatenate(gaps) > min(_WAITS[best], _WAITS[said])))
    return float(_WAITS[best]) if silences >= _ENOUGH and errors[best] < _ERRORS_LEFT * errors[said] else None


def has_silence(piece: CommandedMotion, slowest: float) -> bool:
    """Say whether a command to move is followed by none for a while."""
    moves = (np.abs(piece.given) > slowest).any(axis=1)
    return bool((moves & (piece.gaps() > _SILENCE)).any())


def _near(piece: CommandedMotion, moves: Bools) -> Bools:
    """Say which steps [K] are around a silence after a command to move."""
    gaps = piece.gaps()
    silent = moves & (gaps > _SILENCE)
    first = np.searchsorted(piece.start, piece.t[silent] - _BEFORE)
    last = np.searchsorted(piece.start, piece.t[silent] + gaps[silent] + _AFTER)
    inside = np.zeros(len(piece.start) + 1, int)
    np.add.at(inside, first, 1)
    np.add.at(inside, last, -1)
    return np.asarray((np.cumsum(inside)[:-1] > 0) & (piece.start > piece.t[0] + _SETTLED))


def _answers(piece: CommandedMotion, channel: int, near: Bools) -> Iterator[Floats]:
    """Give what drives that follow a command to the full do in some steps, [K, waits, lags] of each delay."""
    grid = np.arange(piece.t[0], piece.stop[-1] + _STEP, _STEP)
    middle = grid + 0.5 * _STEP
    held = np.searchsorted(piece.t, middle, side="right") - 1
    age, asked = middle - piece.t[held], piece.given[held, channel]
    follows = 1.0 - np.exp(-_STEP / _LAGS)
    given = np.where(age[:, None] <= _WAITS, asked[:, None], 0.0)[:, :, None]
    speed = np.zeros((len(grid) + 1, len(_WAITS), len(_LAGS)))
    for before, after, aim in zip(speed[:-1], speed[1:], given, strict=True):
        np.subtract(aim, before, out=after)
        after *= follows
        after += before
    way = np.zeros_like(speed)
    np.cumsum(0.5 * _STEP * (speed[:-1] + speed[1:]), axis=0, out=way[1:])
    start, stop = piece.start[near], piece.stop[near]
    for delay in _DELAYS:
        first, last = (_index(each - delay - piece.t[0], len(grid)) for each in (start, stop))
        yield (way[last] - way[first]) / (stop - start)[:, None, None]


def _index(seconds: Floats, last: int) -> Ints:
    return np.clip(np.rint(seconds / _STEP).astype(np.int64), 0, last)
