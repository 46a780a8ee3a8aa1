# SPDX-License-Identifier: Apache-2.0
"""The next moves make the worst prediction surer than others do, and are found in small pieces of work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from excitation.samples import SPACE

from slipwise.excitation import NextMoves, choose_next_moves, prior_knowledge
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
from slipwise.excitation.next_moves import HOLD, PAUSE

COMMANDS = SPACE.grid(3)[np.any(SPACE.grid(3) != 0.0, axis=1)]
KNOWN = prior_knowledge(SPACE)


def found(
    knowledge: Knowledge = KNOWN, commands: np.ndarray = COMMANDS, count: int = 3
) -> tuple[NextMoves, int]:
    """Return the moves, and in how many pieces they were found."""
    work, pieces = choose_next_moves(knowledge, np.sqrt(np.diag(KNOWN.covariance)), commands, count), 0
    while True:
        try:
            next(work)
        except StopIteration as done:
            return done.value, pieces
        pieces += 1


def told(command: np.ndarray) -> np.ndarray:
    v, vy, omega = command.tolist()
    move = Move(v, omega, HOLD, PAUSE, vy)
    return information(move_jacobians(KNOWN, [move])[0], PoseStd())


def test_the_three_moves_are_as_good_as_the_best_three_of_all_but_a_tenth() -> None:
    parts = np.array([told(command) for command in COMMANDS])
    places = np.array(np.triu_indices(len(COMMANDS), 1))
    judge = WorstPrediction(prediction_jacobians(KNOWN, COMMANDS, 2.0))
    known = prior_information(KNOWN)
    best = min(
        judge.scores(known + parts[i] + parts[places[0]] + parts[places[1]]).min()
        for i in range(len(COMMANDS))
    )
    (moves, _) = found()
    last = moves.moves[-1]
    score = 2.0 * np.log(last.yaw) + 2.0 * np.log(last.position)
    assert best - 1e-9 <= score <= best + 2.0 * np.log(1.1) * 2.0
    yaws = np.array([moves.now[0], *(move.yaw for move in moves.moves)])
    assert (np.diff(yaws) < 0.0).all()
    assert moves.now == pytest.approx(moves.prior)


def test_moves_differ_and_each_names_what_it_teaches() -> None:
    moves, pieces = found()
    assert len({(each.move.v, each.move.omega) for each in moves.moves}) == 3
    assert {each.teaches for each in moves.moves} <= set(KNOWN.names)
    assert pieces >= 3 + 3 * len(COMMANDS) // 16


def test_of_moves_that_help_alike_the_first_counts() -> None:
    for commands in (COMMANDS, COMMANDS[::-1]):
        first = found(commands=commands, count=1)[0].moves[0].move
        mirrored = [(-first.v, first.omega), (first.v, -first.omega), (-first.v, -first.omega)]
        rows = commands[:, ::2].tolist()
        place = rows.index([first.v, first.omega])
        assert place <= min(rows.index(list(each)) for each in mirrored)


def test_a_covariance_that_is_none_is_refused() -> None:
    broken = replace(KNOWN, covariance=np.full_like(KNOWN.covariance, np.nan))
    with pytest.raises(np.linalg.LinAlgError):
        found(broken)
