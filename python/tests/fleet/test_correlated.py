# SPDX-License-Identifier: Apache-2.0
"""Trends and walks are those of references; scatter that lasts, or that a season brings, is no wear."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.wear_bound import BEYOND, KINDS, Fleet, alarms_of, false_wear

from slipwise.fleet import correlated
from slipwise.fleet.correlated import FEWEST_OF_WALK, Series, trends, walks
from slipwise.fleet.findings import without_common_course

SIGMA = 0.004


def walked(seed: int, rate: float, logs: int = 60) -> tuple[Series, float]:
    """Return logs of a parameter that walks, and where it ended."""
    random = np.random.default_rng(seed)
    metres = np.cumsum(random.uniform(50.0, 400.0, logs))
    truth = -0.1 + np.cumsum(
        np.sqrt(rate * np.diff(metres, prepend=metres[0])) * random.standard_normal(logs)
    )
    values = truth + SIGMA * random.standard_normal(logs)
    return Series(np.arange(float(logs)), metres, values, np.full(logs, SIGMA)), float(truth[-1])


def test_the_rate_of_a_walk_is_found_and_where_it_is_now() -> None:
    drawn = [walked(seed, 1e-6) for seed in range(20)]
    found = [
        walks([series])[0] for series, _ in drawn
    ]  # a whole fleet that walks looks like ground that lasts
    assert all(walk.chance < 0.01 for walk in found)
    assert np.exp(np.mean([np.log(walk.rate) for walk in found])) == pytest.approx(1e-6, rel=0.3)
    off = [abs(walk.level - truth) / walk.level_std for walk, (_, truth) in zip(found, drawn, strict=True)]
    assert 0.7 <= np.mean(np.array(off) <= 1.645) <= 1.0  # 0.9 expected of 20 draws


def test_a_trend_is_that_of_least_squares_with_the_covariance_of_the_scatter() -> None:
    random = np.random.default_rng(1)
    days = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 9.0])
    stds = random.uniform(0.5, 2.0, 7)
    series = Series(days, days, random.standard_normal(7), stds)
    size, kept = correlated._candidates()
    at = int(np.flatnonzero((size > 1.0) & (kept == 0.65))[0])
    fit = correlated._lines(series)
    places = np.concatenate(([0.0], np.cumsum(series.gaps)))
    lasting = size[at] * series.unit * kept[at] ** np.abs(places[:, None] - places)
    precision = np.linalg.inv(lasting + np.diag(stds**2))
    line = np.stack([np.ones(7), days], axis=1)
    covariance = np.linalg.inv(line.T @ precision @ line)
    slope = (covariance @ line.T @ precision @ series.values)[1]
    assert fit.slope[at] == pytest.approx(slope, rel=1e-9)
    assert fit.variance[at] == pytest.approx(covariance[1, 1], rel=1e-9)


def test_logs_that_tell_no_walk_say_so() -> None:
    series, _ = walked(1, 1e-6, FEWEST_OF_WALK)
    assert series.walks
    assert not Series(series.days, np.zeros(FEWEST_OF_WALK), series.values, series.stds).walks
    few = [array[1:] for array in (series.days, series.metres, series.values, series.stds)]
    assert not Series(*few).walks
    assert trends([]) == walks([]) == []


@pytest.mark.slow
def test_the_likelihood_of_a_walk_is_that_of_statsmodels() -> None:
    structural = pytest.importorskip("statsmodels.tsa.statespace.structural")
    random = np.random.default_rng(3)
    values = np.cumsum(0.02 * random.standard_normal(80)) + 0.05 * random.standard_normal(80)
    series = Series(np.arange(80.0), np.arange(80.0), values, np.full(80, 0.05))
    found = correlated._filtered(series)
    for place in (5, 12):
        expected = structural.UnobservedComponents(values, "local level")
        noises = [0.0025, float(correlated._RATES[place]) * 0.0025]
        assert found.likelihood[place, 0] == pytest.approx(expected.loglike(noises), rel=1e-5)
        smoothed = expected.filter(noises)
        assert found.level[place, 0] == pytest.approx(smoothed.filtered_state[0, -1], rel=1e-5)
        assert found.variance[place, 0] == pytest.approx(smoothed.filtered_state_cov[0, 0, -1], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("scatter", KINDS)
def test_a_fleet_without_wear_seldom_alarms(scatter: str) -> None:
    random = np.random.default_rng(3)
    fleet = Fleet(kind=scatter, size=BEYOND)
    alarmed = [any(kind == "drift" for _, kind in alarms_of(random, SIGMA, 0.0, fleet)) for _ in range(60)]
    assert np.mean(alarmed) <= 0.12  # 0.05 asked; three standard deviations of 60 draws; 0.9 and more before


@pytest.mark.slow
@pytest.mark.parametrize("scatter", KINDS)
def test_wear_is_seen_in_at_most_a_twentieth_of_small_fleets_without_it(scatter: str) -> None:
    random = np.random.default_rng(5)
    alarmed = false_wear(random, SIGMA, Fleet(3, 12, scatter, BEYOND), 250)
    assert alarmed <= 0.07  # 0.05 asked, 0.044 measured at most; 1.4 standard errors of 250 fleets


def test_a_season_is_taken_out_of_three_robots_and_its_doubt_is_counted() -> None:
    days = np.arange(12.0)
    random = np.random.default_rng(6)
    season = 10.0 * SIGMA * np.sin(days / 3.0)
    noise = SIGMA * random.standard_normal((3, 12))
    drawn = [Series(days, days, -0.1 + season + each, np.full(12, SIGMA)) for each in noise]
    left = without_common_course(drawn)
    of_others = 0.5 * (noise[1] + noise[2])
    np.testing.assert_allclose(
        left[0].values - left[0].values.mean(),
        noise[0] - of_others - np.mean(noise[0] - of_others),
        atol=0.3 * SIGMA,
    )
    assert left[0].stds[0] == pytest.approx(np.sqrt(1.5) * SIGMA, rel=0.02)
    assert without_common_course(drawn[:2]) == drawn[:2]
