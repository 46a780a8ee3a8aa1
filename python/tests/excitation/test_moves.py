# SPDX-License-Identifier: Apache-2.0
"""Figures of moves are closed and mirrored whatever the slip is."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.excitation import CommandSpace, drawn_robots, prior_knowledge
from slipwise.excitation.moves import ORDERS, Move, command_periods, figure_of, start_times

SPACE = CommandSpace(1.0, 1.0)


def test_every_move_is_answered_by_its_reverse_and_its_mirror_image(subtests: pytest.Subtests) -> None:
    for order in ORDERS:
        with subtests.test(order=order):
            moves = figure_of([(0.5, 0.8), (1.0, 0.2)], order, 2.0, 0.5)
            told = sorted((move.v, move.omega) for move in moves)
            assert told == sorted((-v, -w) for v, w in told)
            assert told == sorted((v, -w) for v, w in told)


def test_heading_returns_whatever_the_slip_is(subtests: pytest.Subtests) -> None:
    for order in ORDERS:
        with subtests.test(order=order):
            knowledge = prior_knowledge(SPACE, dynamics=False)
            moves = figure_of([(0.5, 0.8), (1.0, 0.2)], order, 2.0, 0.0)
            paths = drawn_robots(knowledge, 20, seed=3).paths(command_periods(moves, 0.1))
            np.testing.assert_allclose(paths[:, 2, -1], 0.0, atol=1e-9)
            assert np.abs(paths[:, 2]).max() > 1.0


def test_robot_without_slip_ends_where_it_began() -> None:
    moves = figure_of([(0.5, 0.8), (1.0, 0.2)], ORDERS[0], 2.0, 0.5)
    robot = drawn_robots(prior_knowledge(SPACE, dynamics=False).spread_by(0.0), 1, seed=1)
    end = robot.paths(command_periods(moves, 0.1))[0, :, -1]
    np.testing.assert_allclose(end, 0.0, atol=1e-9)


def test_periods_hold_the_command_and_then_stand() -> None:
    periods = command_periods([Move(1.0, -0.5, 0.2, 0.1)], 0.1)
    np.testing.assert_array_equal(periods, [[1.0, 0.0, -0.5], [1.0, 0.0, -0.5], [0.0, 0.0, 0.0]])


def test_moves_follow_each_other_without_a_gap() -> None:
    moves = [Move(1.0, 0.0, 2.0, 0.5), Move(-1.0, 0.0, 1.0, 0.0)]
    np.testing.assert_allclose(start_times(moves, 1.0), [1.0, 3.5, 4.5])
