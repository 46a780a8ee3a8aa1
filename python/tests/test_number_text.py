# SPDX-License-Identifier: Apache-2.0
"""Numbers as people read them."""

import pytest

from slipwise.number_text import estimate_text, number_text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1234.5, "1234"), (0.012345, "0.0123"), (1e-9, "1e-09"), (float("nan"), "–")],
)
def test_numbers_have_three_digits(value: float, text: str) -> None:
    assert number_text(value) == text


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (1.6789, 0.0234, "1.68 ± 0.02"),
        (0.18234, 0.0152, "0.182 ± 0.015"),
        (-0.05, 0.000035, "-0.05000 ± 0.00003"),
        (-0.0000001, 0.02, "0.00 ± 0.02"),
        (12345.0, 250.0, "12345 ± 250"),
        (0.5, 1e-9, "0.500000 ± <0.000001"),
        (0.5, 0.0, "0.500 ± 0"),
        (0.5, float("nan"), "0.500 ± –"),
        (3.0, 1.3e7, "3 ± 1.3e+07"),
    ],
)
def test_an_estimate_ends_where_its_standard_deviation_does(value: float, std: float, text: str) -> None:
    assert estimate_text(value, std) == text


def test_what_a_computation_rounds_off_is_zero() -> None:
    assert number_text(2.8e-17) == "0"
