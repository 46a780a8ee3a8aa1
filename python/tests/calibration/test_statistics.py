# SPDX-License-Identifier: Apache-2.0
"""Summaries, intervals and coverage say what their names say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.calibration.predictions import Predictions
from slipwise.calibration.statistics import (
    coverage,
    nis_band,
    normal_coverage,
    ratio_of_means,
    summarise,
)
from slipwise.student import MOST_DOF


def predictions(measured: np.ndarray, pose: np.ndarray, covariance: np.ndarray) -> Predictions:
    size = len(pose)
    t = np.arange(size, dtype=np.float64)
    return Predictions(
        method="toy",
        horizon=1.0,
        run=np.zeros(size, np.int64),
        t_start=t,
        t_end=t + 1.0,
        pose=pose,
        covariance=covariance,
        inflation=np.ones(size),
        dof=np.full(size, MOST_DOF),
        nominal_nis=np.full(size, 3.0),
        measured=measured,
        learned_until=t,
        structure=np.zeros(size, np.int64),
        in_sample=np.zeros((size, 2)),
    )


def test_errors_of_a_hand_made_set_are_as_by_hand() -> None:
    measured = np.array([[3.0, 4.0, 0.1], [1.0, 0.0, 3.1], [0.0, 0.0, 7.0]])
    pose = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, -3.1], [0.0, 0.0, 0.5]])
    covariance = np.tile(np.diag([4.0, 1.0, 0.01]), (3, 1, 1))
    p = predictions(measured, pose, covariance)
    assert p.position_error == pytest.approx([5.0, 2.0, 0.0])
    wrapped = 2.0 * np.pi - 6.2
    assert p.heading_error == pytest.approx([0.1, wrapped, 6.5 - 2.0 * np.pi])
    assert p.nis[0] == pytest.approx(9.0 / 4.0 + 16.0 + 0.01 / 0.01)
    assert p.nis[1] == pytest.approx(4.0 + wrapped**2 / 0.01)
    assert p.causal


def test_residual_does_not_change_what_was_measured() -> None:
    measured, pose = np.full((2, 3), 5.0), np.zeros((2, 3))
    p = predictions(measured, pose, np.tile(np.eye(3), (2, 1, 1)))
    assert p.residual[0, 2] == pytest.approx(5.0 - 2.0 * np.pi)
    assert (measured == 5.0).all()
    assert not pose.any()


def test_no_predictions_have_no_nis() -> None:
    assert len(predictions(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3, 3))).nis) == 0


def test_summary_of_a_few_errors_is_as_by_hand() -> None:
    summary = summarise(np.array([1.0, 2.0, 3.0, 6.0]))
    assert summary.mean == pytest.approx(3.0)
    assert summary.median == pytest.approx(2.5)
    assert summary.rmse == pytest.approx(np.sqrt(12.5))
    assert summary.p95 == pytest.approx(5.55)


def test_interval_has_a_width_and_contains_the_mean(subtests: pytest.Subtests) -> None:
    for count in [2, 3, 4, 5, 7, 50]:
        with subtests.test(count=count):
            for seed in range(20):
                errors = np.random.default_rng(seed).exponential(size=count)
                summary = summarise(errors)
                assert summary.low < summary.mean < summary.high
                assert errors.min() <= summary.low + 1e-12
                assert summary.high <= errors.max() + 1e-12


def test_interval_covers_the_true_mean_about_as_often_as_it_says() -> None:
    hits = 0
    for seed in range(200):
        summary = summarise(np.random.default_rng(seed).exponential(size=60))
        hits += summary.low <= 1.0 <= summary.high
    assert 0.86 <= hits / 200 <= 0.99


def test_correlated_errors_have_a_wider_interval_than_the_same_ones_shuffled() -> None:
    rng = np.random.default_rng(4)
    noise = rng.standard_normal(600)
    slow = np.abs(np.convolve(noise, np.ones(10) / 10.0, mode="same")) + 0.1
    ordered, shuffled = summarise(slow), summarise(rng.permutation(slow))
    assert ordered.high - ordered.low > 1.4 * (shuffled.high - shuffled.low)


def test_ratio_is_that_of_the_means_and_pairs_windows() -> None:
    reference = np.random.default_rng(1).exponential(size=40)
    assert ratio_of_means(reference, reference) == pytest.approx((1.0, 1.0, 1.0))
    assert ratio_of_means(0.25 * reference, reference) == pytest.approx((0.25, 0.25, 0.25))
    value, low, high = ratio_of_means(
        np.array([1.0, 2.0, 1.0, 2.0, 5.0]), np.array([2.0, 2.0, 2.0, 2.0, 2.0])
    )
    assert value == pytest.approx(1.1)
    assert low < value < high


def test_ratio_to_a_reference_that_is_never_wrong_is_not_a_number() -> None:
    assert np.isnan(ratio_of_means(np.ones(5), np.zeros(5))).all()


def test_ratio_survives_samples_without_any_error_of_the_reference() -> None:
    reference = np.zeros(6)
    reference[0] = 1.0
    value, low, high = ratio_of_means(np.ones(6), reference)
    assert value == pytest.approx(6.0)
    assert np.isfinite([low, high]).all()


def test_gaussian_residuals_are_covered_as_often_as_stated() -> None:
    rng = np.random.default_rng(2)
    count = 4000
    root = np.array([[0.2, 0.0, 0.0], [0.1, 0.3, 0.0], [0.02, -0.05, 0.1]])
    covariance = np.tile(root @ root.T, (count, 1, 1))
    residuals = rng.standard_normal((count, 3)) @ root.T
    p = predictions(residuals, np.zeros((count, 3)), covariance)
    for fraction, stated in zip(normal_coverage(p.reported_nis), (0.5, 0.9, 0.95), strict=True):
        assert fraction == pytest.approx(stated, abs=3.0 * np.sqrt(stated * (1.0 - stated) / count))
    low, high = nis_band(count)
    assert low < p.nis.mean() < high


def test_residuals_of_a_t_are_covered_as_often_as_it_states() -> None:
    rng, count, dof = np.random.default_rng(12), 4000, 4.0
    covariance = np.tile(np.diag([0.04, 0.09, 0.01]), (count, 1, 1))
    spread = np.sqrt((dof - 2.0) / rng.chisquare(dof, (count, 1))) * np.array([0.2, 0.3, 0.1])
    residuals = rng.standard_normal((count, 3)) * spread
    p = replace(predictions(residuals, np.zeros((count, 3)), covariance), dof=np.full(count, dof))
    for fraction, stated in zip(coverage(p.inside), (0.5, 0.9, 0.95), strict=True):
        assert fraction == pytest.approx(stated, abs=3.0 * np.sqrt(stated * (1.0 - stated) / count))
    assert normal_coverage(p.nis)[0] > 0.6, "a normal distribution of the same covariance is too wide inside"


def test_reported_nis_is_that_of_the_covariance_without_growth() -> None:
    p = predictions(np.full((3, 3), 0.1), np.zeros((3, 3)), np.tile(np.eye(3), (3, 1, 1)))
    assert replace(p, inflation=np.full(3, 4.0)).reported_nis == pytest.approx(4.0 * p.nis)


@pytest.mark.parametrize("count", [3, 10, 100])
def test_nis_band_holds_the_mean_of_independent_windows_in_95_of_100_cases(count: int) -> None:
    means = np.random.default_rng(3).chisquare(3.0, size=(4000, count)).mean(axis=1)
    low, high = nis_band(count)
    assert np.mean((means >= low) & (means <= high)) == pytest.approx(0.95, abs=0.012)


def test_coverage_counts_the_ellipsoids_edge_as_inside() -> None:
    assert normal_coverage(np.array([0.0, 2.3659738843753377, 6.0, 7.0])) == (0.5, 0.75, 1.0)
    assert coverage(np.array([0.0, 0.5, 0.9, 0.94])) == (0.5, 0.75, 1.0)
