# SPDX-License-Identifier: Apache-2.0
"""Two experts become one probability (expert_pool); doubt and newness speak for an unknown surface."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.pool import Pool, Rejection, doubt_of, pooled, rejection_at

HALF, THIRD = np.array([[0.5, 0.5]]), np.array([[0.8, 0.2]])


def pool(vibration: float, current: float) -> Pool:
    return Pool(vibration, current, -1.0, 0.5, 2.0, ())


def test_an_expert_who_does_not_know_changes_nothing() -> None:
    alone, together = pooled(pool(1.0, 0.0), THIRD, HALF), pooled(pool(1.0, 1.0), THIRD, HALF)
    np.testing.assert_allclose(alone, together)


def test_two_who_agree_are_surer_than_one() -> None:
    assert pooled(pool(1.0, 1.0), THIRD, THIRD)[0, 0] > pooled(pool(1.0, 0.0), THIRD, THIRD)[0, 0]


def test_nobody_rules_a_surface_out_alone() -> None:
    sure, other = np.array([[1.0, 0.0]]), np.array([[0.02, 0.98]])
    assert pooled(pool(1.0, 1.0), sure, other)[0, 1] == pytest.approx(
        0.01 * 0.99 / (0.01 * 0.99 + 1.01 * 0.03)
    )


def test_an_unused_expert_may_say_nothing() -> None:
    assert np.isfinite(pooled(pool(0.0, 1.0), np.full((1, 2), np.nan), THIRD)).all()
    assert pooled(pool(1.0, 1.0), np.empty((0, 2)), np.empty((0, 2))).shape == (0, 2)


def test_doubt_and_newness_raise_the_probability_of_unknown() -> None:
    made = pool(1.0, 1.0)
    base = made.unknown(THIRD, np.zeros(1))[0]
    assert made.unknown(HALF, np.zeros(1))[0] > base
    assert made.unknown(THIRD, np.ones(1))[0] > base
    assert doubt_of(THIRD)[0] == pytest.approx(np.log(0.25))


def test_the_cheapest_rejection_that_finds_enough_is_taken() -> None:
    steps = tuple(Rejection(share, share / 2, 1.0 - share) for share in (0.2, 0.5, 0.8))
    assert [rejection_at(steps, share).unknown for share in (0.1, 0.2, 0.6, 0.95)] == [0.2, 0.2, 0.8, 0.8]
