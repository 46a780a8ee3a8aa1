# SPDX-License-Identifier: Apache-2.0
"""Numbers as people read them."""

import pytest

from slipwise.number_text import number_text


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1234.5, "1234"), (0.012345, "0.0123"), (1e-9, "1e-09"), (float("nan"), "–")],
)
def test_numbers_have_three_digits(value: float, text: str) -> None:
    assert number_text(value) == text
