# SPDX-License-Identifier: Apache-2.0
"""Stated uncertainties are called untrue only where held-out errors are far from them."""

from __future__ import annotations

import numpy as np
import pytest
from calibration.test_statistics import predictions

from slipwise.calibration.consistency import Consistency, consistency_of


def drawn(count: int, scale: float, seed: int = 1) -> Consistency:
    """Errors that are `scale` times as large as stated."""
    rng = np.random.default_rng(seed)
    covariance = np.broadcast_to(np.diag([0.04, 0.01, 0.0025]), (count, 3, 3)).copy()
    errors = scale * rng.standard_normal((count, 3)) * np.sqrt([0.04, 0.01, 0.0025])
    found = consistency_of(predictions(errors, np.zeros((count, 3)), covariance))
    assert found is not None
    return found


def test_true_ellipsoids_are_not_spoken_of(subtests: pytest.Subtests) -> None:
    for seed in range(20):
        with subtests.test(seed=seed):
            found = drawn(60, 1.0, seed)
            assert found.true
            assert found.sentence() == ""
            assert found.advice() == ()


def test_ellipsoids_that_are_too_small_are_named_with_the_factor_that_mends_them() -> None:
    found = drawn(200, 3.0)
    assert found.too_small
    assert found.nis == pytest.approx(27.0, rel=0.3)
    assert found.sentence().startswith("Its reported uncertainty is too small: the 95 % ellipsoids hold ")
    assert found.advice()[0].startswith("Multiply predicted covariances by ")
    assert found.factor == pytest.approx(9.0, rel=0.3)
    assert drawn(200, 10.0).untrue


def test_ellipsoids_that_are_too_large_are_said_where_there_are_enough_segments() -> None:
    assert drawn(200, 0.2).too_large
    assert "too large" in drawn(200, 0.2).sentence()
    assert drawn(16, 0.2).true  # eight held-out segments: the prior's caution shows
    assert not drawn(200, 0.2).untrue


def test_the_second_half_alone_counts() -> None:
    found = drawn(61, 1.0)
    assert found.segments == 31


def test_few_errors_that_are_very_large_are_heavy_tails_and_no_covariance_to_multiply() -> None:
    rng = np.random.default_rng(3)
    errors = rng.standard_normal((200, 3))
    errors[[101, 130, 171]] *= 20.0
    found = consistency_of(predictions(errors, np.zeros((200, 3)), np.tile(np.eye(3), (200, 1, 1))))
    assert found is not None
    assert found.true
    assert found.nis > 10.0
    assert "heavy tails: the 95 % ellipsoids hold 9" in found.sentence()
    assert "Multiply" not in " ".join(found.advice())
