# SPDX-License-Identifier: Apache-2.0
"""The page in a headless Chromium without network; surfaces come and go where there are many."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from reporting.browser import Browser, find_browser
from reproduction.toy_chapters import exhibit, solid, toy_results

from slipwise.reproduction import ChapterResult
from slipwise.reproduction.draw_page import draw_page

STATE = "document.documentElement.dataset"
CANVASES = "document.querySelectorAll('.plot canvas').length"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    program = find_browser()
    if program is None:
        reason = "there is no Chromium on the PATH (Debian: apt install chromium)"
        if os.environ.get("SLIPWISE_REQUIRE_BROWSER") == "1":
            pytest.fail(reason)
        pytest.skip(reason)
    with Browser(program, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


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


def test_of_many_surfaces_only_those_near_the_window_are_drawn(browser: Browser, tmp_path: Path) -> None:
    exhibits = tuple(exhibit(f"figure-8-{place}", solid(place)) for place in range(20))
    page = tmp_path / "index.html"
    page.write_text(draw_page([ChapterResult("many", "Many surfaces", exhibits)]), encoding="utf-8")
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
