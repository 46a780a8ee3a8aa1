# SPDX-License-Identifier: Apache-2.0
"""How long a watchdog waits: commands that end after a while, with a delay and a lag, fitted to motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from slipwise.logs.findings.commanded_motion import CommandedMotion
from slipwise.logs.log import Bools, Floats, Ints

#: Tried [s]; the last is no watchdog.
_WAITS = np.concatenate((np.arange(0.1, 1.5, 0.05), np.arange(1.5, 4.01, 0.1), [np.inf]))
_DELAYS = np.arange(0.0, 0.61, 0.05)  # s, tried
_LAGS = np.array((0.03, 0.1, 0.2, 0.3, 0.5, 0.8))  # s, tried
_STEP = 0.025  # s, of the grid
_SETTLED = 2.0  # s after the start of a piece; how the robot moved before it is not known
_SILENCE = 0.3  # s without a command
_BEFORE, _AFTER = 1.0, 2.5  # s around a silence; a robot that starts again shows its delay
_FEWEST = 3  # silences that are longer than the watchdog waits
_LEFT = 0.6  # of the squared errors without a watchdog, those with one are less


def waited(pieces: Sequence[CommandedMotion], slowest: float) -> float | None:
    """Return how long [s] a command lasts that is not repeated; None where too little shows it.

    Args:
        pieces: of one robot.
        slowest: commands up to this [m/s or rad/s] are none to move.
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
    best = int(np.argmin(errors))
    silences = int(np.sum(np.concatenate(gaps) > _WAITS[best]))
    return float(_WAITS[best]) if silences >= _FEWEST and errors[best] < _LEFT * errors[-1] else None


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
    speed, way = np.zeros((len(_WAITS), len(_LAGS))), np.zeros((len(grid) + 1, len(_WAITS), len(_LAGS)))
    for k, (seconds, value) in enumerate(zip(age.tolist(), asked.tolist(), strict=True)):
        before = speed
        speed = before + follows * (np.where(seconds <= _WAITS, value, 0.0)[:, None] - before)
        way[k + 1] = way[k] + 0.5 * _STEP * (before + speed)
    start, stop = piece.start[near], piece.stop[near]
    for delay in _DELAYS:
        first, last = (_index(each - delay - piece.t[0], len(grid)) for each in (start, stop))
        yield (way[last] - way[first]) / (stop - start)[:, None, None]


def _index(seconds: Floats, last: int) -> Ints:
    return np.clip(np.rint(seconds / _STEP).astype(np.int64), 0, last)
