# SPDX-License-Identifier: Apache-2.0
"""Vehicles that are alike share what is known of their scatter; one that is not keeps its own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise.fleet.scatter import digamma, shared_scatter, trigamma

FREEDOM = np.full(40, 28.0)


def test_vehicles_that_are_alike_count_as_one() -> None:
    excess = np.random.default_rng(1).chisquare(28.0, 40) / 28.0
    shared, freedom = shared_scatter(excess, FREEDOM)
    assert np.std(shared) < 0.3 * np.std(excess)
    assert shared == pytest.approx(np.ones(40), abs=0.15)
    assert freedom.min() > 200.0


def test_prior_is_that_of_the_vehicles_drawn() -> None:
    random = np.random.default_rng(2)
    truth = 3.0 * 10.0 / random.chisquare(10.0, 4000)  # scaled inverse chi-square of ten degrees
    excess = truth * random.chisquare(28.0, 4000) / 28.0
    shared, freedom = shared_scatter(excess, np.full(4000, 28.0))
    assert freedom == pytest.approx(np.full(4000, 38.0), rel=0.05)
    assert np.mean(np.log(shared / truth) ** 2) < 0.8 * np.mean(np.log(excess / truth) ** 2)


def test_vehicle_unlike_the_others_keeps_its_own_scatter() -> None:
    excess = np.array([1.0, 0.9, 1.1, 1.2, 0.8, 25.0])
    shared, freedom = shared_scatter(excess, np.full(6, 28.0))
    assert shared[-1] > 20.0
    assert freedom[-1] < 40.0


@pytest.mark.parametrize("excess", [np.array([4.0]), np.array([1.0, 9.0])])
def test_few_vehicles_say_nothing_of_each_other(excess: np.ndarray) -> None:
    freedom = np.full(len(excess), 5.0)
    assert shared_scatter(excess, freedom)[0] is excess
    assert shared_scatter(excess, freedom)[1] is freedom


def test_logs_on_a_line_make_no_other_vehicle_exact() -> None:
    shared, freedom = shared_scatter(np.array([0.0, 1.0, 1.1, 0.9]), np.full(4, 10.0))
    assert np.isfinite(shared).all()
    assert shared[1] > 0.5
    assert (freedom >= 10.0).all()


def test_digamma_and_trigamma_are_those_of_the_tables() -> None:
    assert digamma(1.0) == pytest.approx(-0.5772156649015329, abs=1e-10)
    assert digamma(0.5) == pytest.approx(-0.5772156649015329 - 2.0 * math.log(2.0), abs=1e-10)
    assert trigamma(1.0) == pytest.approx(math.pi**2 / 6.0, abs=1e-10)
    assert trigamma(0.5) == pytest.approx(math.pi**2 / 2.0, abs=1e-10)
