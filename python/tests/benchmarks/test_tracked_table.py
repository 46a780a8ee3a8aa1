# SPDX-License-Identifier: Apache-2.0
"""`benchmarks/tracked_table.py` finds slip and side-slip angle that are known, and predicts rows unseen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tracked_table
from tracked_table import Table

TURN = np.array([0.03, -0.13])  # what yaw adds to the forward and the sideways speed
SLIP_STD, ANGLE_STD = 0.004, 0.02


def driven(seed: int) -> Table:
    """Return a grid of steady states whose slip is cubic in the yaw rate."""
    rng = np.random.default_rng(seed)
    left, right = (side.ravel() for side in np.meshgrid(np.linspace(-1, 1, 12), np.linspace(-0.9, 0.9, 8)))
    table = Table(0.5 * (left + right), 0.5 * (right - left), np.zeros((left.size, 3)))
    slip = -0.03 * table.omega - 0.02 * table.omega**3 + 0.01 * table.v
    angle = tracked_table.angles(table, TURN) + rng.normal(0.0, ANGLE_STD, left.size)
    noise = rng.normal(0.0, SLIP_STD, (left.size, 2))
    return replace(table, measured=np.column_stack((slip + noise[:, 0], -slip + noise[:, 1], angle)))


def test_rows_that_stand_still_are_left_out_and_speeds_scaled(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(
        "wheel_l,wheel_r,beta_l,beta_r,alpha\n0,0,0.1,0.1,3\n-160,160,0.1,-0.1,-1.5\n80,80,0,0,0\n"
    )
    table = tracked_table.read_table(path)
    np.testing.assert_allclose(table.v, [0.0, 0.5])
    np.testing.assert_allclose(table.omega, [1.0, 0.0])
    np.testing.assert_allclose(table.measured[0], [0.1, -0.1, -1.5])


def test_terms_are_those_of_each_degree_with_and_without_signs() -> None:
    assert tracked_table.terms(1) == ["V^1", "sgn(V)*V^1", "w^1", "abs(w)", "sgn(V)*w^1", "sgn(V)*abs(w)"]
    assert [len(tracked_table.terms(degree)) for degree in (2, 3)] == [16, 30]


def test_no_two_terms_are_the_same_function() -> None:
    x = tracked_table.features(driven(1), tracked_table.terms(3))
    assert np.linalg.matrix_rank(x) == x.shape[1]


def test_slip_that_is_made_of_terms_is_predicted_to_its_noise() -> None:
    table = driven(2)
    for side in (0, 1):
        mean, std = tracked_table.slip_left_out(table, side)
        error = mean - table.measured[:, side]
        assert np.sqrt(np.mean(error**2)) < 1.4 * SLIP_STD
        assert np.mean(np.abs(error) <= 2.0 * std) > 0.9


def test_a_row_does_not_help_to_predict_itself() -> None:
    table = driven(3)
    measured = table.measured.copy()
    measured[40] += 0.5
    bent = replace(table, measured=measured)
    before, after = (tracked_table.slip_left_out(t, 0)[0][40] for t in (table, bent))
    assert after == pytest.approx(before, abs=1e-9)


def test_what_yaw_adds_is_found() -> None:
    rows = np.ones(96, dtype=bool)
    found = [tracked_table.learn_turn(driven(seed), rows, np.zeros(2), 12) for seed in range(20)]
    np.testing.assert_allclose(np.mean(found, axis=0), TURN, atol=4e-3)


def test_angles_left_out_are_right_on_both_sides_of_backwards() -> None:
    table = driven(4)
    predicted = np.column_stack((table.measured[:, :2], tracked_table.angle_left_out(table)))
    assert np.median(np.abs(tracked_table.errors(table, predicted)[:, 2])) < 1.2 * ANGLE_STD


def test_folds_hold_each_row_once() -> None:
    assert np.all(np.sum(list(tracked_table.folds(driven(5), 0)), axis=0) == 1)


def test_a_fold_is_predicted_without_itself() -> None:
    table = driven(6)

    def method(_: Table, rows: np.ndarray) -> np.ndarray:
        return np.column_stack([~rows, ~rows, ~rows]).astype(float)

    assert np.all(tracked_table.held_out(table, method, 0) == 1.0)


def test_right_predictions_explain_everything_and_the_mean_nothing() -> None:
    table = driven(7)
    np.testing.assert_allclose(tracked_table.explained(table, table.measured.copy()), 1.0)
    mean = np.tile(table.measured.mean(axis=0), (len(table.v), 1))
    np.testing.assert_allclose(tracked_table.explained(table, mean)[:2], 0.0, atol=1e-12)
