# SPDX-License-Identifier: Apache-2.0
"""Where a surface is asked: numbers and arrays of one length, or words for what is wrong."""

import math

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_thesis.surfaces.surface import drive_arrays, not_fitted


def test_numbers_and_arrays_become_arrays_of_one_length() -> None:
    v, omega = drive_arrays(1, [0.1, 0.2, 0.3])
    assert v.tolist() == [1.0, 1.0, 1.0]
    assert omega.tolist() == [0.1, 0.2, 0.3]
    assert v.flags.c_contiguous
    assert v.dtype == np.float64
    assert [len(part) for part in drive_arrays(1.0, 2.0)] == [1, 1]


@pytest.mark.parametrize("wrong", [math.nan, math.inf, [[1.0, 2.0], [3.0, 4.0]]])
def test_what_is_not_finite_or_has_two_dimensions_is_refused(wrong: object) -> None:
    with pytest.raises(SettingsError, match="finite and of one dimension"):
        drive_arrays(wrong, 0.0)  # type: ignore[arg-type]


def test_a_surface_that_learned_nothing_says_what_to_call() -> None:
    assert "call fit" in str(not_fitted())
