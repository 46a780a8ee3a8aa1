# SPDX-License-Identifier: Apache-2.0
"""A walk's rate is found, seldom where there is none, and its likelihood is that of a reference library."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.fleet.random_walk import FEWEST, filtered, random_walk

SIGMA = 0.004


def drawn(seed: int, rate: float, scatter: float = 0.0, logs: int = 60) -> tuple[np.ndarray, ...]:
    """Way driven [m], values and their standard deviations; the last truth comes last."""
    random = np.random.default_rng(seed)
    metres = np.cumsum(random.uniform(50.0, 400.0, logs))
    steps = np.sqrt(rate * np.diff(metres, prepend=metres[0])) * random.standard_normal(logs)
    truth = -0.1 + np.cumsum(steps)
    noise = np.hypot(SIGMA, scatter) * random.standard_normal(logs)
    return metres, truth + noise, np.full(logs, SIGMA), truth[-1:]


def test_the_rate_of_a_walk_is_found() -> None:
    rates = []
    for seed in range(20):
        metres, values, stds, _ = drawn(seed, 1e-6)
        walk = random_walk(metres, values, stds)
        assert walk is not None
        assert walk.chance < 1e-3
        rates.append(walk.rate)
    assert np.exp(np.mean(np.log(rates))) == pytest.approx(1e-6, rel=0.2)


def test_the_present_level_is_within_its_deviation() -> None:
    off = []
    for seed in range(60):
        metres, values, stds, last = drawn(seed, 1e-6)
        walk = random_walk(metres, values, stds)
        assert walk is not None
        off.append((walk.level - last[0]) / walk.level_std)
    assert np.mean(np.abs(off) <= 1.645) == pytest.approx(0.9, abs=0.09)  # of 60 draws


@pytest.mark.parametrize("scatter", [0.0, 0.02])
def test_what_does_not_walk_seldom_seems_to(scatter: float) -> None:
    chances = []
    for seed in range(100):
        metres, values, stds, _ = drawn(seed, 0.0, scatter)
        walk = random_walk(metres, values, stds)
        assert walk is not None
        chances.append(walk.chance)
    assert np.mean(np.array(chances) < 0.05) <= 0.11  # 0.05 asked; three standard deviations of 100 draws


def test_few_logs_or_no_way_between_them_say_nothing() -> None:
    metres, values, stds, _ = drawn(1, 1e-6)
    assert random_walk(metres[: FEWEST - 1], values[: FEWEST - 1], stds[: FEWEST - 1]) is None
    assert random_walk(np.zeros(60), values, stds) is None


@pytest.mark.slow
def test_the_likelihood_is_that_of_statsmodels() -> None:
    structural = pytest.importorskip("statsmodels.tsa.statespace.structural")
    random = np.random.default_rng(3)
    values = np.cumsum(0.02 * random.standard_normal(80)) + 0.05 * random.standard_normal(80)
    model = structural.UnobservedComponents(values, "local level")
    for noise, rate in ((0.0025, 0.0004), (0.01, 0.0001)):
        expected = model.loglike([noise, rate])  # the first value sets the level there, too
        series = np.ones(79), values, np.full(80, np.sqrt(noise))
        likelihood, level, variance = filtered(series, np.array([rate]), np.array([0.0]))
        assert likelihood[0] == pytest.approx(expected, rel=1e-5)
        smoothed = model.filter([noise, rate])
        assert level[0] == pytest.approx(smoothed.filtered_state[0, -1], rel=1e-5)
        assert variance[0] == pytest.approx(smoothed.filtered_state_cov[0, 0, -1], rel=1e-4)
