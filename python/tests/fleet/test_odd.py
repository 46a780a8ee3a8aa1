# SPDX-License-Identifier: Apache-2.0
"""Of a few robots the one that is another stands out, and robots of one type seldom do."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.fleet.findings import discoveries
from slipwise.fleet.odd import Estimates, odd_ones

PARAMETERS = 8
CORRELATED = 0.4  # the errors of a robot's parameters


def _alarms(random: np.random.Generator, robots: int, between: float, off: float = 0.0) -> np.ndarray:
    """Return which of [parameters, robots] alarm; the last robot is off in the first."""
    own = CORRELATED * np.ones((PARAMETERS, PARAMETERS)) + (1.0 - CORRELATED) * np.eye(PARAMETERS)
    std = random.lognormal(0.0, 0.3, (PARAMETERS, robots))
    value = std * (np.linalg.cholesky(own) @ random.standard_normal((PARAMETERS, robots)))
    value[:2] += between * random.standard_normal((2, robots))  # of two parameters robots of a type differ
    value[0, -1] += off
    found = odd_ones([Estimates(value[k], std[k], np.ones(robots)) for k in range(PARAMETERS)])
    chances = [found[k][place].chance for k in range(PARAMETERS) for place in range(robots)]
    return np.reshape(discoveries(chances), (PARAMETERS, robots))


@pytest.mark.parametrize("robots", [4, 6])
@pytest.mark.parametrize("between", [0.0, 3.0, 10.0])
def test_robots_of_one_type_seldom_alarm(robots: int, between: float) -> None:
    random = np.random.default_rng(11)
    alarmed = [bool(_alarms(random, robots, between).any()) for _ in range(60)]
    assert np.mean(alarmed) <= 0.12  # 0.05 asked; three standard deviations of 60 draws are 0.08


def test_one_of_four_robots_that_is_another_is_found_and_no_other() -> None:
    random = np.random.default_rng(12)
    alarms = [_alarms(random, 4, 0.0, off=20.0) for _ in range(30)]
    assert np.mean([each[0, -1] for each in alarms]) >= 0.9
    assert sum(int(each.sum()) - int(each[0, -1]) for each in alarms) <= 2


def test_one_parameter_alone_says_little_of_how_much_three_robots_differ() -> None:
    value, std = np.array([0.0, 0.5, -0.5, 15.0]), np.ones(4)
    mine = Estimates(value, std, std)
    alone = odd_ones([mine])[0][3].chance
    among = odd_ones([mine, *(Estimates(value * [1, 1, 1, 0], std, std) for _ in range(9))])
    assert alone > 0.001
    assert among[0][3].chance < 0.2 * alone


def test_the_least_size_that_alarms_is_where_its_chance_is() -> None:
    std = np.ones(6)
    found = odd_ones([Estimates(np.array([0.1, -0.4, 0.3, 0.0, 0.2, 7.0]), std, std)])[0][5]
    assert found.least(found.chance) == pytest.approx(found.size, rel=0.05)
    assert found.least(1e-3 * found.chance) > found.size


def test_two_robots_cannot_tell_which_is_odd() -> None:
    std = np.array([1.0, 1.0, np.nan])
    assert odd_ones([Estimates(9.0 * std, std, std)]) == [{}]
