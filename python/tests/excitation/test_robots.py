# SPDX-License-Identifier: Apache-2.0
"""Robots are drawn as they are likely, and their boxes hold their paths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.excitation import CommandSpace, drawn_robots, prior_knowledge
from slipwise.excitation.moves import ORDERS, command_periods, figure_of
from slipwise.excitation.robots import edge_radius, edge_robots

KNOWLEDGE = prior_knowledge(CommandSpace(1.0, 1.0))
COMMANDS = command_periods(figure_of([(0.5, 0.5)], ORDERS[0], 2.0, 0.5), 0.1)


@pytest.mark.parametrize(("size", "radius"), [(1, 3.0), (2, 3.44), (10, 5.18), (14, 5.72)])
def test_edge_holds_what_three_sigma_hold_in_one_dimension(size: int, radius: float) -> None:
    assert edge_radius(size) == pytest.approx(radius, abs=0.05)


def test_box_holds_every_path_and_the_start() -> None:
    robots = drawn_robots(KNOWLEDGE, 10, seed=2)
    paths = robots.paths(COMMANDS)
    x, y = paths[:, 0], paths[:, 1]
    lowest, highest = np.minimum([x.min(), y.min()], 0.0), np.maximum([x.max(), y.max()], 0.0)
    np.testing.assert_allclose(robots.box(COMMANDS), [lowest[0], highest[0], lowest[1], highest[1]])


def test_room_that_the_robots_just_fill_holds_them_and_a_smaller_one_does_not() -> None:
    robots = drawn_robots(KNOWLEDGE, 10, seed=2)
    box = robots.box(COMMANDS)
    size = np.array([box[1] - box[0], box[3] - box[2]])
    inside, end = robots.inside(COMMANDS[None], size)
    paths = robots.paths(COMMANDS)
    assert inside[0]
    assert end[0] == pytest.approx(np.hypot(paths[:, 0, -1], paths[:, 1, -1]).max())
    assert not robots.inside(COMMANDS[None], size - (1e-6, 0.0))[0][0]
    assert not robots.inside(COMMANDS[None], size - (0.0, 1e-6))[0][0]


def test_one_sequence_does_not_change_the_answer_about_another() -> None:
    robots = drawn_robots(KNOWLEDGE, 10, seed=2)
    both, _ = robots.inside(np.stack((20.0 * COMMANDS, 0.1 * COMMANDS)), np.array([5.0, 5.0]))
    assert both.tolist() == [False, True]


def test_same_seed_draws_the_same_robots() -> None:
    first, second = (drawn_robots(KNOWLEDGE, 3, seed=5).paths(COMMANDS) for _ in range(2))
    np.testing.assert_array_equal(first, second)
    assert np.abs(first - drawn_robots(KNOWLEDGE, 3, seed=6).paths(COMMANDS)).max() > 0.01


def test_robots_at_the_edge_come_farther_than_likely_ones() -> None:
    likely, edge = (draw(KNOWLEDGE, 100, seed=2).box(COMMANDS) for draw in (drawn_robots, edge_robots))
    assert edge[1] - edge[0] > likely[1] - likely[0]


def test_robots_of_several_kinds_are_drawn_by_weight_and_rare_ones_often_enough() -> None:
    other = prior_knowledge(CommandSpace(1.0, 1.0), basis="edd-2")
    other = replace(other, mean=other.mean - 0.2)
    both = replace(KNOWLEDGE, kinds=((0.99, KNOWLEDGE), (0.01, other)))

    def rare(least: float) -> int:
        paths = drawn_robots(both.spread_by(0.0), 1000, seed=3, least=least).paths(COMMANDS)
        return 1000 - int(np.sum(np.all(paths == paths[0], axis=(1, 2))))

    assert rare(0.0) == pytest.approx(10, abs=10)
    assert rare(0.1) == pytest.approx(91, abs=30)
    assert len(edge_robots(both, 20, seed=3).programs) == 22


def test_exact_knowledge_gives_the_expected_robot_each_time() -> None:
    paths = drawn_robots(KNOWLEDGE.spread_by(0.0), 2, seed=1).paths(COMMANDS)
    np.testing.assert_array_equal(paths[0], paths[1])
