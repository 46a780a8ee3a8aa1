# SPDX-License-Identifier: Apache-2.0
"""Recorded rows are put in order, and what cannot be used is counted."""

from __future__ import annotations

import numpy as np
import pytest
from dynamics.sample_systems import CART

from slipwise.dynamics.learn_dynamics import recorded
from slipwise.errors import LogError


def test_rows_that_cannot_be_used_are_counted() -> None:
    inputs = [[0.0, 1.0], [2.0, 1.0], [1.0, 1.0], [1.0, 5.0], [3.0, np.nan]]
    measured = [[-1.0, 0.0], *([0.1 * k, 0.0] for k in range(12)), [0.5, 9.0], [np.inf, 0.0]]
    found = recorded(CART, inputs, measured)
    assert found.input_t.tolist() == [0.0, 1.0, 2.0]
    assert len(found.t) == 12
    assert (np.diff(found.t) > 0.0).all()
    assert found.left_out == 2 + 3


def test_what_is_no_recorded_drive_is_refused(subtests: pytest.Subtests) -> None:
    for inputs, measured, message in [
        ([[0.0]], [[0.0, 0.0]], r"the inputs have shape \(1, 1\)"),
        ([[0.0, 1.0]], [[0.0, 0.0, 0.0]], r"the measurements have shape \(1, 3\)"),
        ([["a", "b"]], [[0.0, 0.0]], "no table of numbers"),
        ([[0.0, 1.0]], [[0.1 * k, 0.0] for k in range(9)], "9 measurements"),
        ([[5.0, 1.0]], [[0.1 * k, 0.0] for k in range(20)], "0 measurements after the first"),
    ]:
        with (
            subtests.test(inputs=inputs, measured=measured, message=message),
            pytest.raises(LogError, match=message),
        ):
            recorded(CART, inputs, measured)  # type: ignore[arg-type]
