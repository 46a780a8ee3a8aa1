# SPDX-License-Identifier: Apache-2.0
"""Small pieces of HTML."""

from __future__ import annotations

import pytest

from slipwise.reporting.markup import escape, number, table


def test_number_has_three_digits_or_a_dash(subtests: pytest.Subtests) -> None:
    for value, text in [
        (0.0, "0"),
        (0.060789, "0.0608"),
        (-12.345, "−12.3"),
        (1234.5, "1234"),
        (2.5e-9, "2.5e−09"),
        (1.6e9, "1.6e+09"),
        (float("nan"), "–"),
        (float("inf"), "–"),
    ]:
        with subtests.test(value=value, text=text):
            assert number(value) == text


def test_escape_leaves_no_markup_no_control_characters_and_valid_utf_8() -> None:
    assert escape('<a href="x">\'&') == "&lt;a href=&quot;x&quot;&gt;&#x27;&amp;"
    assert escape("a\x00b\x1b[0m") == "a�b�[0m"
    assert escape("\udcff") == "?"


def test_table_escapes_its_cells_and_scrolls_in_its_own_box() -> None:
    html = table(("<a>",), [("<b>",)])
    assert "<a>" not in html
    assert "<b>" not in html
    assert html.startswith('<div class="scroll"')
