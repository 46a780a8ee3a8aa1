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


@pytest.mark.parametrize(
    ("stamps", "kept"),
    [
        (
            (0.0, 1.0, 2.0, 1.2, 1.8, 2.5),
            (True, True, True, False, False, True),
        ),  # go back until they are new
        ((0.0, 0.1, 500.0, 0.3, 0.4, 0.5), (True, True, False, True, True, True)),  # one in the far future
        ((1e9, 0.1, 0.2, 0.3, 0.4, 0.5), (False, True, True, True, True, True)),  # the first one is
    ],
)
def test_stamps_that_do_not_go_on_are_left_out_and_silence_no_others(
    stamps: tuple[float, ...], kept: tuple[bool, ...]
) -> None:
    keep, _, backward = forward_stamps(np.array(stamps))
    assert keep.tolist() == list(kept)
    assert backward.sum() == kept.count(False)


@given(
    arrays(np.float64, st.integers(0, 40), elements=st.floats(-5.0, 5.0).map(lambda value: round(value, 1)))
)
def test_what_is_kept_increases_and_every_sample_is_accounted_for(t: np.ndarray) -> None:
    keep, duplicate, backward = forward_stamps(t)
    assert (np.diff(t[keep]) > 0).all()
    assert (keep.astype(int) + duplicate + backward == 1).all()


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
