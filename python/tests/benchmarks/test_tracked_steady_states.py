# SPDX-License-Identifier: Apache-2.0
"""Scores of steady states are what a known robot gives."""

from __future__ import annotations

import numpy as np
import pytest
import tracked_steady_states as steady  # type: ignore[import-not-found]


@pytest.fixture(scope="module")
def states() -> tuple[np.ndarray, np.ndarray]:
    """Speeds and half differences of the tracks, 200 each, none of them zero."""
    rng = np.random.default_rng(1)
    return rng.uniform(0.2, 1.0, 200) * rng.choice((-1.0, 1.0), 200), rng.uniform(-1.0, 1.0, 200)


def test_slip_that_the_terms_hold_is_explained_whole(states: tuple[np.ndarray, np.ndarray]) -> None:
    v, w = states
    slip = 0.1 * v - 0.2 * w
    assert steady.slip_score(("V", "w"), v, w, slip, 0) > 0.999


def test_noise_is_not_explained(states: tuple[np.ndarray, np.ndarray]) -> None:
    v, w = states
    noise = np.random.default_rng(2).normal(0.0, 0.05, 200)
    assert steady.slip_score(("V", "w"), v, w, noise, 0) < 0.05


def test_the_angle_of_a_displaced_centre_of_rotation_is_found(states: tuple[np.ndarray, np.ndarray]) -> None:
    v, w = states
    alpha = np.arctan2(-0.3 * w, v) + np.random.default_rng(3).normal(0.0, 0.01, 200)
    assert steady.angle_score(v, w, alpha, 0) > 0.99


def test_angles_are_compared_round_the_circle() -> None:
    assert steady.wrapped(np.array([2.0 * np.pi - 0.1]))[0] == pytest.approx(-0.1)
