# SPDX-License-Identifier: Apache-2.0
"""The prior of a new robot is that of the robots drawn, and counts the prior of no log twice."""

from __future__ import annotations

import numpy as np
import pytest
from fleet.fleet_samples import MEAN, known_fleet

from slipwise.calibration.log_knowledge import LearnedNormal
from slipwise.fleet.start_prior import new_robot, start_prior


def learned(truth: np.ndarray, std: float, random: np.random.Generator) -> LearnedNormal:
    """The posterior of a measurement under a prior of 0 with a standard deviation of 0.3."""
    measured = truth + std * random.standard_normal(len(truth))
    share = 0.09 / (0.09 + std**2)
    covariance = share * std**2 * np.eye(len(truth))
    return LearnedNormal(share * measured, covariance, np.zeros(len(truth)), np.full(len(truth), 0.3))


@pytest.mark.parametrize("std", [0.01, 0.1])
def test_robots_drawn_give_mean_and_spread_however_sure_each_log_is(std: float) -> None:
    random = np.random.default_rng(1)
    robots = [(str(k), learned(random.normal(-0.2, 0.1, 2), std, random)) for k in range(300)]
    prior = new_robot(robots)
    assert prior is not None
    mean, covariance = prior
    np.testing.assert_allclose(mean, -0.2, atol=0.05)
    spread = np.sqrt(np.diag(covariance))
    assert ((spread > 0.09) & (spread < 0.16)).all()  # Student's t takes normal robots for a little wider


def test_intervals_hold_the_next_robot() -> None:
    random, held = np.random.default_rng(2), []
    for _ in range(60):
        truth = random.normal(-0.2, 0.1, (13, 2))
        prior = new_robot([(str(k), learned(each, 0.05, random)) for k, each in enumerate(truth[:12])])
        assert prior is not None
        held.append(np.abs(prior[0] - truth[12]) <= 1.645 * np.sqrt(np.diag(prior[1])))
    assert np.mean(held) == pytest.approx(0.9, abs=0.085)  # three standard deviations of 120 draws


@pytest.mark.slow
@pytest.mark.parametrize("robots", [2, 3, 5])
def test_intervals_of_few_robots_hold_the_next_one(robots: int) -> None:
    """Robots differ by a fifth of a log's prior, about as the guess of their spread says."""
    random, held = np.random.default_rng(robots), []
    for _ in range(150):
        truth = random.normal(-0.2, 0.06, (robots + 1, 2))
        prior = new_robot([(str(k), learned(each, 0.02, random)) for k, each in enumerate(truth[:-1])])
        assert prior is not None
        held.append(np.abs(prior[0] - truth[-1]) <= 1.645 * np.sqrt(np.diag(prior[1])))
    assert 0.85 <= np.mean(held) <= 0.95


def test_what_no_robot_shows_is_no_surer_than_before_any_log() -> None:
    blind = LearnedNormal(np.zeros(1), np.array([[0.09]]), np.zeros(1), np.array([0.3]))
    prior = new_robot([("a", blind), ("b", blind)])
    assert prior is not None
    assert 0.2 < np.sqrt(prior[1][0, 0]) <= 0.31


def test_logs_of_one_robot_that_differ_widen_the_prior() -> None:
    random = np.random.default_rng(3)

    def spread(by_ground: float) -> float:
        robots = [
            (str(k), learned(np.array([-0.2 + g * by_ground]), 0.01, random))
            for k in range(4)
            for g in (-1, 1)
        ]
        prior = new_robot(robots)
        assert prior is not None
        return float(np.sqrt(prior[1][0, 0]))

    assert spread(0.2) > spread(0.0) + 0.05


def test_one_odd_robot_hurts_little() -> None:
    random = np.random.default_rng(4)
    robots = [(str(k), learned(np.array([-0.2]), 0.01, random)) for k in range(9)]
    prior = new_robot([*robots, ("odd", learned(np.array([0.5]), 0.01, random))])
    assert prior is not None
    assert abs(prior[0][0] + 0.2) < 0.03


@pytest.mark.slow
def test_the_prior_of_logs_is_that_of_their_robots() -> None:
    start = start_prior(known_fleet())
    assert start is not None
    assert (start.input, start.structure) == ("wheel", "joint")
    prior = start.bases["edd-2"]
    for value, truth, variance in zip(prior.mean, MEAN, np.diag(prior.covariance), strict=True):
        assert abs(value - truth) < 3.0 * np.sqrt(variance)
        assert np.sqrt(variance) < 0.15
    assert sum(each.weight for each in start.bases.values()) == pytest.approx(1.0)


@pytest.mark.slow
def test_one_robot_says_nothing_of_the_next() -> None:
    (_, known), *_ = known_fleet()
    assert start_prior([("one", known), ("one", known)]) is None
    assert start_prior([]) is None
