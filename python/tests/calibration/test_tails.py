# SPDX-License-Identifier: Apache-2.0
"""Heavy tails and wrong sizes of held-out errors are learned causally, and ellipsoids hold their share."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.calibration.statistics import coverage
from slipwise.calibration.tails import learn_tails
from slipwise.student import LEAST_DOF, MOST_DOF, share_inside

WINDOWS, LOGS = 200, 40
EARLIER = np.arange(WINDOWS)  # each window is predicted when all before it are known


def squared_lengths(rng: np.random.Generator, dof: float, scale: float, count: int = WINDOWS) -> np.ndarray:
    """Squared lengths of draws of a 3-D t; normal ones where `dof` is infinite."""
    mixing = 1.0 if np.isinf(dof) else rng.chisquare(dof, count) / dof
    return scale * rng.chisquare(3.0, count) / mixing


@pytest.mark.slow
@pytest.mark.parametrize("dof", [3.0, 6.0, np.inf])
@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_ellipsoids_hold_their_share_whatever_the_tails(dof: float, scale: float) -> None:
    rng, inside = np.random.default_rng(4), []
    for _ in range(LOGS):
        squared = squared_lengths(rng, dof, scale)
        tails = learn_tails(EARLIER, squared)
        inside.append(share_inside(squared / tails.growth, tails.dof)[WINDOWS // 2 :])
    assert coverage(np.concatenate(inside)) == pytest.approx((0.50, 0.90, 0.95), abs=0.03)


def test_covariance_is_that_of_normal_errors() -> None:
    tails = learn_tails(np.array([5000]), squared_lengths(np.random.default_rng(5), np.inf, 4.0, 5000))
    assert tails.growth[0] == pytest.approx(4.0, rel=0.15)
    assert tails.dof[0] > 12.0


def test_heavy_tails_are_told_from_large_errors() -> None:
    rng = np.random.default_rng(6)
    heavy, large = (
        learn_tails(np.array([3000]), squared_lengths(rng, dof, scale, 3000))
        for dof, scale in ((3.0, 1.0), (np.inf, 3.0))
    )
    assert heavy.dof[0] == pytest.approx(3.0, abs=0.5)
    assert heavy.growth[0] == pytest.approx(3.0, rel=0.3)
    assert large.dof[0] > 3.0 * heavy.dof[0]


def test_few_windows_stay_at_the_prior_and_many_leave_it() -> None:
    squared = squared_lengths(np.random.default_rng(7), np.inf, 25.0)
    prior = learn_tails(np.array([0]), np.empty(0))
    tails = learn_tails(EARLIER, squared)
    assert tails.growth[0] == prior.growth[0]
    assert tails.dof[0] == prior.dof[0]
    assert 2.5 < prior.dof[0] < 8.0, "a size that is not known has heavy tails itself"
    assert prior.growth[0] < tails.growth[3] < 2.0 * 25.0
    assert tails.growth[-1] == pytest.approx(25.0, rel=0.3)


def test_only_known_windows_count_to_the_last_bit() -> None:
    squared = squared_lengths(np.random.default_rng(8), 4.0, 2.0, 400)
    known = np.maximum(np.arange(400) - 2, 0)
    whole = learn_tails(known, squared)
    for cut in (1, 127, 128, 129, 300):
        part = learn_tails(known[:cut], squared[:cut])
        assert part.growth.tobytes() == whole.growth[:cut].tobytes()
        assert part.dof.tobytes() == whole.dof[:cut].tobytes()
    spoilt = np.where(np.arange(400) >= 200, 1e9, squared)
    assert learn_tails(known[:203], spoilt).dof[:202].tobytes() == whole.dof[:202].tobytes()


def test_order_of_the_predictions_does_not_matter() -> None:
    squared = squared_lengths(np.random.default_rng(9), 5.0, 1.0, 300)
    known = np.random.default_rng(10).permutation(301)
    assert (learn_tails(known, squared).growth == learn_tails(np.sort(known), squared).growth[known]).all()


@pytest.mark.parametrize("length", [0.0, 1e-30, 1e300, np.inf])
def test_absurd_errors_give_a_usable_distribution(length: float) -> None:
    tails = learn_tails(np.array([50]), np.full(50, length))
    assert 0.0 < tails.growth[0] < 1e5
    assert LEAST_DOF <= tails.dof[0] <= MOST_DOF


@pytest.mark.parametrize("falls_to", [0.1, 10.0])
def test_a_covariance_that_becomes_truer_while_it_is_learned_is_followed(falls_to: float) -> None:
    rng, inside = np.random.default_rng(12), []
    drift = falls_to ** np.linspace(1.0, 0.0, WINDOWS)  # of the errors beside what was stated
    for _ in range(LOGS):
        squared = drift * squared_lengths(rng, 8.0, 1.0)
        tails = learn_tails(EARLIER, squared)
        inside.append(share_inside(squared / tails.growth, tails.dof)[WINDOWS // 2 :])
    assert coverage(np.concatenate(inside)) == pytest.approx((0.50, 0.90, 0.95), abs=0.1)


def test_one_pose_jump_changes_little() -> None:
    squared = squared_lengths(np.random.default_rng(11), np.inf, 1.0)
    spoilt = np.where(np.arange(WINDOWS) == 50, 1e6, squared)
    clean, jumped = (learn_tails(np.array([WINDOWS]), values) for values in (squared, spoilt))
    assert jumped.growth[0] < 2.0 * clean.growth[0]
