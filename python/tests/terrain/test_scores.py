# SPDX-License-Identifier: Apache-2.0
"""Scores of probabilities."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.scores import expected_calibration_error, score_of


def test_scores_of_three_windows() -> None:
    probability = np.array([[0.8, 0.2], [0.6, 0.4], [0.3, 0.7]])
    score = score_of(probability, np.array(["a", "b", "b"], dtype=object), ["a", "b"])
    assert (score.windows, score.accuracy) == (3, pytest.approx(2 / 3))
    assert score.recall == {"a": 1.0, "b": 0.5}
    assert score.log_loss == pytest.approx(-np.log([0.8, 0.4, 0.7]).mean())
    assert score.calibration_error == pytest.approx((0.2 + 0.6 + 0.3) / 3)


def test_a_surface_that_does_not_occur_has_no_recall() -> None:
    score = score_of(np.array([[0.9, 0.1]]), np.array(["a"], dtype=object), ["a", "b"])
    assert np.isnan(score.recall["b"])


def test_true_confidence_has_a_small_calibration_error_and_boasting_a_large_one() -> None:
    rng = np.random.default_rng(0)
    confidence = rng.uniform(0.5, 1.0, 20_000)
    right = rng.uniform(size=20_000) < confidence
    assert expected_calibration_error(confidence, right) < 0.02
    assert expected_calibration_error(np.full(20_000, 0.99), right) == pytest.approx(0.24, abs=0.01)
