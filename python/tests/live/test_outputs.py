# SPDX-License-Identifier: Apache-2.0
"""A bar is empty at the prior, full at the target, and says nothing where a number makes no sense."""

from __future__ import annotations

import math

import pytest
from sample_models import make_model, named

from slipwise.live.outputs import filled
from slipwise.models.parameter_table import physical_parameters


def test_a_bar_fills_by_the_logarithm_of_the_standard_deviation() -> None:
    assert filled(0.4, 0.4, 0.1) == 0.0
    assert filled(0.4, 0.2, 0.1) == pytest.approx(0.5)
    assert filled(0.4, 0.1, 0.1) == filled(0.4, 0.05, 0.1) == 1.0
    assert filled(0.4, 0.5, 0.1) == 0.0
    assert filled(0.1, 0.15, 0.2) == 1.0


@pytest.mark.parametrize("numbers", [(0.0, 0.1, 0.1), (0.4, math.nan, 0.1), (0.4, 0.1, math.nan)])
def test_a_number_that_makes_no_sense_gives_no_bar(numbers: tuple[float, float, float]) -> None:
    assert filled(*numbers) is None


def test_a_parameter_without_a_target_is_never_full_before_it_is_known_exactly() -> None:
    assert filled(0.4, 1e-6, 0.0) == 0.0


def test_a_bar_is_full_where_the_parameter_is_identified_and_only_there() -> None:
    rows = physical_parameters(make_model(named("odd-even-10")))
    assert {row.identified for row in rows} >= {True} or {row.identified for row in rows} >= {False}
    for row in rows:
        assert (row.std <= row.target_std) == row.identified
