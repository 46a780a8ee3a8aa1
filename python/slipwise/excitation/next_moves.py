# SPDX-License-Identifier: Apache-2.0
"""The next few moves worth driving, of a robot under way: found in small pieces of work."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.excitation.design import HORIZON
from slipwise.excitation.information import (
    PoseStd,
    WorstPrediction,
    information,
    move_jacobians,
    prediction_jacobians,
    prior_information,
)
from slipwise.excitation.knowledge import Knowledge
from slipwise.excitation.moves import Move

Floats = NDArray[np.float64]

HOLD, PAUSE = 2.0, 0.5  # s of a command, and of standing after it
SWEEPS = 1  # over the moves, each exchanged for the best beside the others (Fedorov 1972)
NEAR = 0.1  # of a score: candidates nearly as good as the best, of which the first counts
SMALLEST = 1e-9  # standard deviation of what was known before anything was learned
PIECE = 16  # commands, or candidates, between two pauses of the work


@dataclass(frozen=True)
class NextMove:
    """One move, and the worst prediction over two seconds after it."""

    move: Move
    yaw: float  # rad, largest standard deviation of a predicted yaw
    position: float  # m, largest standard deviation of a predicted position
    teaches: str  # the parameter of which most is learned


@dataclass(frozen=True)
class NextMoves:
    """What to drive next, and how sure the worst prediction is without it."""

    moves: tuple[NextMove, ...]  # the one that helps most alone comes first
    now: tuple[float, float]  # rad, m: yaw and position, as in a move
    prior: tuple[float, float]  # rad, m: before anything was learned


def choose_next_moves(
    knowledge: Knowledge, prior_std: Floats, commands: Floats, count: int = 3
) -> Generator[None, None, NextMoves]:
    """Choose moves after which the worst prediction of all these commands is surest (G-optimality).

    Each is chosen after those before it, and then again beside all others. The robot stands before each.
    Nothing is known of the ground, so that nothing is said of where the robot will be. The generator yields
    after each millisecond of work or so, and returns the result.

    Args:
        knowledge: what was learned.
        prior_std: [parameters] standard deviations before anything was learned.
        commands: (v [m/s], vy [m/s], omega [rad/s]) of moves and predictions, [N, 3]; of moves that help
            alike the first counts.
        count: moves.

    Raises:
        LinAlgError: the covariance cannot be inverted.
    """
    judged: list[Floats] = []
    gains: list[Floats] = []
    for begin in range(0, len(commands), PIECE):
        rows = commands[begin : begin + PIECE]
        judged.append(prediction_jacobians(knowledge, rows, HORIZON))
        gains += [_information_of(knowledge, row) for row in rows.tolist()]
        yield
    search = _Search(WorstPrediction(np.concatenate(judged)), prior_information(knowledge), np.array(gains))
    prior = search.judge.sigmas(np.diag(1.0 / np.maximum(prior_std, SMALLEST) ** 2))
    chosen: list[int] = []
    for _ in range(count):
        chosen.append((yield from search.best_beside(chosen)))
    for place in list(range(count)) * SWEEPS:
        others = chosen[:place] + chosen[place + 1 :]
        chosen[place] = yield from search.best_beside(others)
    return search.result(knowledge, commands, (yield from search.ordered(chosen)), prior)


class _Search:
    """Which of the candidates, by what each tells [N, parameters, parameters]."""

    def __init__(self, judge: WorstPrediction, known: Floats, gains: Floats) -> None:
        self.judge, self._known, self._gains = judge, known, gains

    def best_beside(self, others: list[int]) -> Generator[None, None, int]:
        """Return the candidate after which, and after these others, the worst prediction is surest.

        Raises:
            LinAlgError: a score is not finite.
        """
        known = self._known + self._gains[others].sum(axis=0)
        scores: list[Floats] = []
        for begin in range(0, len(self._gains), PIECE):
            scores.append(self.judge.scores(known + self._gains[begin : begin + PIECE]))
            yield
        all_scores = np.concatenate(scores)
        if not np.isfinite(all_scores).all():
            raise np.linalg.LinAlgError("the covariance is not positive definite")
        all_scores[others] = np.inf  # another move, so that no single one decides
        return int(np.argmax(all_scores <= all_scores.min() + NEAR))

    def ordered(self, chosen: list[int]) -> Generator[None, None, list[int]]:
        """Return the same, each the one that helps most after those before it."""
        left, order = list(chosen), list[int]()
        while left:
            known = self._known + self._gains[order].sum(axis=0)
            best = int(np.argmin(self.judge.scores(known + self._gains[left])))
            order.append(left.pop(best))
            yield
        return order

    def result(
        self, knowledge: Knowledge, commands: Floats, order: list[int], prior: tuple[float, float]
    ) -> NextMoves:
        """Return the moves in this order with what each teaches."""
        known, moves = self._known, []
        for place in order:
            before, known = known, known + self._gains[place]
            gain = np.diag(np.linalg.inv(before)) / np.diag(np.linalg.inv(known))
            v, vy, omega = commands[place].tolist()
            teaches = knowledge.names[int(np.argmax(gain))]
            moves.append(NextMove(Move(v, omega, HOLD, PAUSE, vy), *self.judge.sigmas(known), teaches))
        return NextMoves(tuple(moves), self.judge.sigmas(self._known), prior)


def _information_of(knowledge: Knowledge, command: list[float]) -> Floats:
    """What one move with this command tells, from rest."""
    v, vy, omega = command
    return information(move_jacobians(knowledge, [Move(v, omega, HOLD, PAUSE, vy)])[0], PoseStd())
