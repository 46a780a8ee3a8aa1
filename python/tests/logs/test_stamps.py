# SPDX-License-Identifier: Apache-2.0
"""Tests of what happens to stamps that do not go forward."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from slipwise.logs.stamps import forward_stamps, unit_advice


def test_a_repeated_stamp_is_a_duplicate() -> None:
    keep, duplicate, backward = forward_stamps(np.array([0.0, 1.0, 1.0, 2.0]))
    assert keep.tolist() == [True, True, False, True]
    assert duplicate.tolist() == [False, False, True, False]
    assert not backward.any()


def test_stamps_that_go_back_are_left_out_until_they_are_new_again() -> None:
    keep, _, backward = forward_stamps(np.array([0.0, 1.0, 2.0, 1.2, 1.8, 2.5]))
    assert keep.tolist() == [True, True, True, False, False, True]
    assert backward.sum() == 2


def test_one_stamp_in_the_far_future_does_not_silence_the_rest() -> None:
    keep, _, backward = forward_stamps(np.array([0.0, 0.1, 500.0, 0.3, 0.4, 0.5]))
    assert keep.tolist() == [True, True, False, True, True, True]
    assert backward.sum() == 1


@given(
    arrays(np.float64, st.integers(0, 40), elements=st.floats(-5.0, 5.0).map(lambda value: round(value, 1)))
)
def test_what_is_kept_increases_and_every_sample_is_accounted_for(t: np.ndarray) -> None:
    keep, duplicate, backward = forward_stamps(t)
    assert (np.diff(t[keep]) > 0).all()
    assert (keep.astype(int) + duplicate + backward == 1).all()


def test_a_first_stamp_in_the_far_future_does_not_silence_the_rest() -> None:
    keep, _, backward = forward_stamps(np.array([1e9, 0.1, 0.2, 0.3, 0.4, 0.5]))
    assert keep.tolist() == [False, True, True, True, True, True]
    assert backward.sum() == 1


@pytest.mark.parametrize(
    ("stamp", "expected"),
    [
        (1.7e12, "look like milliseconds, so divide them by 1e+03"),
        (1.7e15, "look like microseconds, so divide them by 1e+06"),
        (1.7e18, "look like nanoseconds, so divide them by 1e+09"),
        (2.0**63, "no time in any unit"),
    ],
)
def test_a_stamp_in_another_unit_is_named(stamp: float, expected: str) -> None:
    assert expected in unit_advice(stamp)
