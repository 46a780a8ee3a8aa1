# SPDX-License-Identifier: Apache-2.0
"""The page of a drive in words, and in a headless Chromium without network."""

from __future__ import annotations

from pathlib import Path

import pytest
from excitation.samples import small_drive
from reporting.browser import Browser
from reporting.page_privacy import assert_sends_nothing

from slipwise.excitation import lessons_of
from slipwise.reporting.excitation_page import excitation_page, summary

STATE = "document.documentElement.dataset"


def test_summary_says_time_limits_gain_and_where_to_start() -> None:
    drive = small_drive()
    text = " ".join(summary(drive, lessons_of(drive)))
    assert f"{len(drive.moves)} moves of 2.00 s" in text
    assert "the limits are 1.00 m/s and 1.00 rad/s" in text
    assert "8.00 m x 7.00 m" in text
    assert "stop button" in text


def test_title_is_shown_as_text() -> None:
    drive = small_drive()
    page = excitation_page(drive, lessons_of(drive), "<b>first</b>")
    assert "<b>first</b>" not in page
    assert "&lt;b&gt;first&lt;/b&gt;" in page


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 420])
def test_four_figures_are_drawn_without_error(browser: Browser, tmp_path: Path, width: int) -> None:
    drive = small_drive()
    path = tmp_path / "drive.html"
    path.write_text(excitation_page(drive, lessons_of(drive), "A drive"), encoding="utf-8")
    browser.open(path, width=width)
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert browser.value(f"{STATE}.drawn") == "4"
    assert_sends_nothing(browser, path)
