# SPDX-License-Identifier: Apache-2.0
"""Numbers as people read them."""

import pytest

from slipwise.number_text import estimate_text, number_text, span_text


def test_numbers_have_three_digits(subtests: pytest.Subtests) -> None:
    for value, text in [
        (0.0, "0"),
        (1234.5, "1234"),
        (0.012345, "0.0123"),
        (1e-9, "1e-09"),
        (float("nan"), "–"),
    ]:
        with subtests.test(value=value, text=text):
            assert number_text(value) == text


def test_an_estimate_ends_where_its_standard_deviation_does(subtests: pytest.Subtests) -> None:
    for value, std, text in [
        (1.6789, 0.0234, "1.68 ± 0.02"),
        (0.18234, 0.0152, "0.182 ± 0.015"),
        (-0.05, 0.000035, "-0.05000 ± 0.00003"),
        (-0.0000001, 0.02, "0.00 ± 0.02"),
        (12345.0, 250.0, "12345 ± 250"),
        (0.5, 1e-9, "0.500000 ± <0.000001"),
        (0.5, 0.0, "0.500 ± 0"),
        (0.5, float("nan"), "0.500 ± –"),
        (3.0, 1.3e7, "3 ± 1.3e+07"),
    ]:
        with subtests.test(value=value, std=std, text=text):
            assert estimate_text(value, std) == text


def test_what_is_nothing_beside_the_other_end_of_a_range_is_zero() -> None:
    assert [
        span_text(ends) for ends in ((1e-9, 1.5), (-0.5, 1.5), (-1.0, 2e-4), (0.0, 0.0), (2e-9, 3e-9))
    ] == [
        "0 to 1.50",
        "-0.500 to 1.50",
        "-1.00 to 0",
        "0 to 0",
        "2e-09 to 3e-09",
    ]


def test_what_a_computation_rounds_off_is_zero() -> None:
    assert number_text(2.8e-17) == "0"
