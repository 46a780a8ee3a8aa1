# SPDX-License-Identifier: Apache-2.0
"""The prior is that of the robots drawn, its intervals hold what they say, and an odd robot hurts little."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.fleet import fleet_prior

MEAN, BETWEEN = np.array([-0.3, 0.1]), np.array([[0.01, 0.004], [0.004, 0.0025]])


def _drawn(random: np.random.Generator, robots: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Truth [N, 2], estimates [N, 2] and their covariances [N, 2, 2]."""
    truth = random.multivariate_normal(MEAN, BETWEEN, robots)
    stds = random.uniform(0.03, 0.15, (robots, 2))
    covariances = np.einsum("ni,ij->nij", stds**2, np.eye(2))
    return truth, truth + stds * random.standard_normal((robots, 2)), covariances


def test_many_robots_give_the_truth_back() -> None:
    _, estimates, covariances = _drawn(np.random.default_rng(1), 2000)
    prior = fleet_prior(estimates, covariances)
    np.testing.assert_allclose(prior.mean, MEAN, atol=0.01)
    np.testing.assert_allclose(prior.between, BETWEEN, atol=0.001)


@pytest.mark.slow
def test_ninety_per_cent_intervals_hold_ninety_per_cent() -> None:
    random = np.random.default_rng(2)
    held = []
    for _ in range(150):
        truth, estimates, covariances = _drawn(random, 20)
        prior = fleet_prior(estimates, covariances)
        std = np.sqrt(np.einsum("nii->ni", prior.shrunk_covariance))
        held.append(np.abs(prior.shrunk - truth) <= 1.645 * std)
    assert 0.87 <= np.mean(held) <= 0.93


def test_shrunk_estimates_are_nearer_to_the_truth() -> None:
    truth, estimates, covariances = _drawn(np.random.default_rng(3), 500)
    prior = fleet_prior(estimates, covariances)
    assert np.mean((prior.shrunk - truth) ** 2) < 0.8 * np.mean((estimates - truth) ** 2)


def test_equal_robots_differ_by_nothing_and_average_exactly() -> None:
    estimates = np.array([[0.5], [0.5], [0.5]])
    stds = np.array([0.1, 0.2, 0.4])
    prior = fleet_prior(estimates, stds[:, None, None] ** 2)
    assert prior.mean[0] == pytest.approx(0.5)
    assert prior.between[0, 0] < 5e-4
    assert prior.mean_covariance[0, 0] == pytest.approx(1.0 / np.sum(stds**-2.0), rel=5e-2)


def test_exact_estimates_give_mean_and_variance_of_the_sample() -> None:
    values = np.random.default_rng(4).normal(2.0, 0.3, 30)
    prior = fleet_prior(values[:, None], np.full((30, 1, 1), 1e-10))
    assert prior.mean[0] == pytest.approx(values.mean(), abs=1e-6)
    assert prior.between[0, 0] == pytest.approx(values.var(ddof=1), rel=1e-3)


def test_one_odd_robot_hurts_the_student_variant_little() -> None:
    random = np.random.default_rng(5)
    values = random.normal(0.0, 0.1, 12)
    values[0] = 5.0
    covariances = np.full((12, 1, 1), 0.02**2)
    normal, student = (
        fleet_prior(values[:, None], covariances),
        fleet_prior(values[:, None], covariances, dof=4.0),
    )
    assert abs(student.mean[0]) < 0.1
    assert abs(normal.mean[0]) > 0.3
    assert student.between[0, 0] < 0.25 * normal.between[0, 0]
    assert student.weight.argmin() == 0


@pytest.mark.slow
def test_one_parameter_is_that_of_statsmodels() -> None:
    """Of equally sure robots, restricted likelihood is what Paule and Mandel (1982) compute."""
    meta = pytest.importorskip("statsmodels.stats.meta_analysis")
    values = np.random.default_rng(7).normal(-0.1, 0.05, 12)
    for std in (0.01, 0.03):
        prior = fleet_prior(values[:, None], np.full((12, 1, 1), std**2))
        expected = meta.combine_effects(values, np.full(12, std**2), method_re="iterated")
        assert prior.between[0, 0] == pytest.approx(expected.tau2, rel=0.03)  # where the search stops
        assert prior.mean[0] == pytest.approx(expected.mean_effect_re, rel=1e-4)
        assert prior.mean_covariance[0, 0] == pytest.approx(expected.var_eff_w_re, rel=0.01)


@pytest.mark.slow
def test_mean_of_robots_that_are_not_equally_sure_is_that_of_statsmodels() -> None:
    """Given the variance between robots, the mean is weighted least squares on a constant."""
    models = pytest.importorskip("statsmodels.regression.linear_model")
    random = np.random.default_rng(9)
    stds = random.uniform(0.01, 0.08, 15)
    values = random.normal(-0.1, 0.05, 15) + stds * random.standard_normal(15)
    prior = fleet_prior(values[:, None], stds[:, None, None] ** 2)
    weights = 1.0 / (stds**2 + prior.between[0, 0])
    fit = models.WLS(values, np.ones(15), weights=weights).fit()
    assert prior.mean[0] == pytest.approx(fit.params[0], rel=1e-6)
    assert prior.mean_covariance[0, 0] == pytest.approx(fit.normalized_cov_params[0, 0], rel=1e-6)

    def restricted(between: float) -> float:
        w = 1.0 / (stds**2 + between)
        off = values - np.sum(w * values) / np.sum(w)
        return float(0.5 * np.sum(np.log(w)) - 0.5 * np.log(np.sum(w)) - 0.5 * np.sum(w * off**2))

    best = restricted(prior.between[0, 0])
    assert best >= max(restricted(factor * prior.between[0, 0]) for factor in (0.8, 0.9, 1.1, 1.25))


def test_a_guess_counts_as_two_robots_and_leaves_no_covariance() -> None:
    values = np.random.default_rng(8).multivariate_normal([0.0, 0.0], [[1.0, 0.9], [0.9, 1.0]], 4)
    prior = fleet_prior(values, np.full((4, 2, 2), 0.0) + 1e-10 * np.eye(2), guess=np.array([0.5, 0.5]))
    expected = (4.0 * values.var(axis=0, ddof=1) + 2.0 * 0.5) / 6.0
    assert np.diag(prior.between) == pytest.approx(expected, rel=0.1)
    assert prior.between[0, 1] == 0.0


def test_units_do_not_matter() -> None:
    _, estimates, covariances = _drawn(np.random.default_rng(6), 20)
    unit = np.array([1e3, 1e-3])
    plain, scaled = (
        fleet_prior(estimates, covariances),
        fleet_prior(estimates * unit, covariances * np.outer(unit, unit)),
    )
    np.testing.assert_allclose(scaled.shrunk, plain.shrunk * unit, rtol=1e-6)


def test_single_robot_is_refused() -> None:
    with pytest.raises(SettingsError, match="two robots"):
        fleet_prior(np.zeros((1, 1)), np.ones((1, 1, 1)))
