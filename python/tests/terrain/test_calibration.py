# SPDX-License-Identifier: Apache-2.0
"""Exponents tame experts who boast, and bounds call the share of strangers unknown that they promise."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.calibration import SHARES, HeldOut, LeftOut, fit_pool
from slipwise.terrain.pool import pooled
from slipwise.terrain.scores import expected_calibration_error
from slipwise.terrain.windows import Windows

SURFACES = ("a", "b", "c")
COUNT = 1500


def softmax(scores: np.ndarray) -> np.ndarray:
    raised = np.exp(scores)
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))


def held_out(boast: float, *, strangers: bool = True) -> HeldOut:
    """Return experts whose scores are the truth's times `boast`, and strangers who look like nothing."""
    rng = np.random.default_rng(0)
    truth = np.arange(COUNT) % 3
    own = softmax(1.5 * rng.standard_normal((COUNT, 3)))
    truth = np.array([rng.choice(3, p=row) for row in own])
    known = LeftOut.empty(COUNT, 3, 1)
    known.vibration[0] = softmax(boast * np.log(own))
    known.current[:] = 1.0 / 3.0
    known.newness[0] = rng.standard_normal(COUNT)
    windows = Windows(
        np.array([f"run {k // 15}" for k in range(COUNT)], dtype=object),
        np.zeros(COUNT),
        np.ones(COUNT),
        np.array(SURFACES, dtype=object)[truth],
        np.zeros((COUNT, 1)),
        np.zeros((COUNT, 1)),
    )
    made = []
    for k in range(3 if strangers else 0):
        stranger = LeftOut.empty(COUNT, 2, 1)
        rows = truth == k
        stranger.vibration[0, rows] = softmax(0.3 * rng.standard_normal((int(rows.sum()), 2)))
        stranger.current[rows] = 0.5
        stranger.newness[0, rows] = 0.7 + rng.standard_normal(int(rows.sum()))
        made.append(stranger)
    return HeldOut("both", known, tuple(made), windows, SURFACES)


@pytest.mark.parametrize("boast", [0.5, 2.0])
def test_probabilities_of_a_boasting_or_a_shy_expert_become_true(boast: float) -> None:
    held = held_out(boast)
    pool, probability, rows = fit_pool(held, 0)
    assert rows.all()
    assert pool.vibration == pytest.approx(1.0 / boast, rel=0.25)
    right = np.array(SURFACES)[probability.argmax(axis=1)] == held.windows.label
    assert expected_calibration_error(probability.max(axis=1), right) < 0.03
    raw = held.known.vibration[0].max(axis=1)
    assert expected_calibration_error(raw, right) > 0.05


def test_a_bound_calls_the_share_of_strangers_unknown_that_it_promises() -> None:
    held = held_out(1.0)
    pool, _, _ = fit_pool(held, 0)
    assert tuple(entry.unknown for entry in pool.rejections) == SHARES
    for entry in pool.rejections:
        found = []
        for stranger in held.strangers:
            rows = stranger.has("both")
            odds = pool.unknown(
                pooled(pool, stranger.vibration[0, rows], stranger.current[rows]), stranger.newness[0, rows]
            )
            found.append(float((odds >= entry.bound).mean()))
        assert np.mean(found) == pytest.approx(entry.unknown, abs=0.01)
    costs = [entry.known for entry in pool.rejections]
    assert costs == sorted(costs)
    assert costs[0] < 0.05 < 0.2 < costs[-1] < 0.9


def test_no_sign_speaks_for_known() -> None:
    pool, _, _ = fit_pool(held_out(1.0), 0)
    assert pool.doubt >= 0.0
    assert pool.newness > 0.0


def test_without_strangers_there_is_no_bound() -> None:
    assert fit_pool(held_out(1.0, strangers=False), 0)[0].rejections == ()


def test_the_shape_with_the_better_log_score_is_chosen() -> None:
    held = held_out(1.0)
    two = LeftOut.empty(COUNT, 3, 2)
    two.vibration[0], two.vibration[1] = 1.0 / 3.0, held.known.vibration[0]
    assert two.best_shape(held.windows, SURFACES) == 1
