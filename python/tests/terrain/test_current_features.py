# SPDX-License-Identifier: Apache-2.0
"""Currents are described by size, spread and ratio to speed; how fast the robot is driven is not told."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.features import CURRENT_FEATURES, current_features


def made(left: float, right: float, speed: float) -> dict[str, float]:
    values = np.tile([left, right, speed, speed], (20, 1))
    return dict(zip(CURRENT_FEATURES, current_features(values), strict=True))


def test_constant_currents_have_their_mean_and_no_spread() -> None:
    found = made(2.0, 4.0, 0.5)
    assert found["left_mean"] == pytest.approx(np.log(2.3))
    assert found["right_least"] == 4.0
    assert found["left_std"] == pytest.approx(np.log(0.1))
    assert found["left_over_right"] == pytest.approx(np.log(2.3 / 4.3))
    assert found["left_right_correlation"] == 0.0


def test_the_sign_of_current_and_speed_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    values = np.abs(rng.standard_normal((30, 4)))
    np.testing.assert_allclose(current_features(-values), current_features(values))


def test_speed_shows_only_where_current_is_divided_by_it() -> None:
    slow, fast = made(2.0, 2.0, 0.2), made(2.0, 2.0, 0.8)
    changed = {name for name in CURRENT_FEATURES if slow[name] != fast[name]}
    assert changed == {"sum_over_speed", "left_over_speed", "right_over_speed"}


def test_currents_that_rise_together_are_correlated() -> None:
    wave = 2.0 + np.sin(np.arange(40.0))
    together = current_features(np.column_stack([wave, 2.0 * wave, wave, wave]))
    against = current_features(np.column_stack([wave, 5.0 - wave, wave, wave]))
    assert (together[-1], against[-1]) == pytest.approx((1.0, -1.0))


def test_standing_is_finite() -> None:
    assert np.isfinite(current_features(np.zeros((5, 4)))).all()


def test_spreads_are_those_of_numpy() -> None:
    values = np.random.default_rng(3).standard_normal((33, 4)) * 5.0
    left, right = np.abs(values[:, :2].T)
    found = dict(zip(CURRENT_FEATURES, current_features(values), strict=True))
    assert found["left_std"] == pytest.approx(np.log(left.std() + 0.1), rel=1e-12)
    assert found["sum_change"] == pytest.approx(np.log(np.diff(left + right).std() + 0.1), rel=1e-12)
    assert found["left_right_correlation"] == pytest.approx(np.corrcoef(left, right)[0, 1], rel=1e-12)
    assert found["left_most"] == pytest.approx(np.log(left.max() + 0.3), rel=1e-12)
