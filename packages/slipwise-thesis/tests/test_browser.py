# SPDX-License-Identifier: Apache-2.0
"""The page in a headless Chromium without network; surfaces come and go where there are many."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from reporting.browser import Browser
from reporting.page_privacy import assert_sends_nothing
from toy_chapters import figure, solid, toy_results

from slipwise_thesis import ChapterResult
from slipwise_thesis.draw_page import draw_page

pytestmark = pytest.mark.slow

STATE = "document.documentElement.dataset"
CANVASES = "document.querySelectorAll('.plot canvas').length"


@pytest.mark.parametrize("width", [1280, 390])
def test_all_kinds_of_panels_are_drawn_without_error_or_request(
    browser: Browser, tmp_path: Path, width: int
) -> None:
    page = tmp_path / "index.html"
    page.write_text(draw_page(toy_results()), encoding="utf-8")
    browser.open(page, width=width)
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert [url for url in browser.requests if not url.startswith("data:")] == [page.as_uri()]
    assert browser.value(f"{STATE}.drawn") == "6"
    assert browser.value("document.documentElement.scrollWidth") == width


def test_no_button_sends_anything(browser: Browser, tmp_path: Path) -> None:
    page = tmp_path / "index.html"
    page.write_text(draw_page(toy_results()), encoding="utf-8")
    browser.open(page, width=1280)
    assert_sends_nothing(browser, page)


def test_of_many_surfaces_only_those_near_the_window_are_drawn(browser: Browser, tmp_path: Path) -> None:
    figures = tuple(figure(f"figure-8-{place}", solid(place)) for place in range(20))
    page = tmp_path / "index.html"
    page.write_text(draw_page([ChapterResult("many", "Many surfaces", figures)]), encoding="utf-8")
    browser.open(page, width=1280)
    for place in (19, 0):
        browser.value(f"document.getElementById('figure-8-{place}').scrollIntoView({{behavior: 'instant'}})")
        deadline = time.monotonic() + 60.0
        shown = f"document.querySelector('#figure-figure-8-{place}-1 canvas') !== null"
        while not browser.value(shown) and time.monotonic() < deadline:
            time.sleep(0.1)
        assert browser.value(shown)
        assert 0 < browser.value(CANVASES) < 16
    assert browser.value(f"{STATE}.errors") == ""
