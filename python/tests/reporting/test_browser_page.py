# SPDX-License-Identifier: Apache-2.0
"""The page in a headless Chromium without network."""

from __future__ import annotations

from pathlib import Path

import pytest
from reporting.browser import Browser
from reporting.page_parts import figures_of
from reporting.page_privacy import assert_sends_nothing
from reporting.synthetic_results import make_results

from slipwise.reporting import write_report

STATE = "document.documentElement.dataset"
HOSTILE = '</script><script>document.documentElement.dataset.owned = "yes"</script><b>'


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    results = make_results(runs=2, run_name=HOSTILE)
    path = tmp_path_factory.mktemp("report") / "report.html"
    parts = {"log": results.log, "calibration": results.calibration, "evaluation": results.evaluation}
    return write_report(path, **parts, title=HOSTILE, command=HOSTILE)


@pytest.fixture(scope="module", params=[1280, 390])
def width(request: pytest.FixtureRequest, browser: Browser, page: Path) -> int:
    """Show the page at a width [px]."""
    browser.open(page, width=request.param)
    return int(request.param)


def test_all_figures_are_drawn_without_error_or_request(
    browser: Browser, page: Path, tmp_path: Path, width: int
) -> None:
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert [url for url in browser.requests if not url.startswith("data:")] == [page.as_uri()]
    names = list(figures_of(page.read_text(encoding="utf-8")))
    assert browser.value(f"{STATE}.drawn") == str(len(names))
    drawn = browser.value(
        "Array.from(document.querySelectorAll('.plot')).filter(p => p.querySelector('.main-svg, canvas')"
        " && p.getBoundingClientRect().width > 250).map(p => p.id)"
    )
    assert drawn == names
    pictures = browser.screenshots(tmp_path, f"report-{width}")
    assert all(picture.stat().st_size > 5000 for picture in pictures[:-1])


def test_no_button_sends_anything(browser: Browser, page: Path) -> None:
    browser.open(page, width=1280)
    assert_sends_nothing(browser, page)


def test_page_never_scrolls_sideways(browser: Browser, width: int) -> None:
    assert browser.value("document.documentElement.scrollWidth") == width
    wide = browser.value(
        "Array.from(document.querySelectorAll('main *'))"
        ".filter(e => !e.closest('.scroll, pre, .plot, details'))"
        f".filter(e => e.getBoundingClientRect().right > {width} + 1).map(e => e.tagName + '.' + e.className)"
    )
    assert wide == []


def test_table_of_scores_fits_a_desktop_and_scrolls_in_its_box_on_phones(
    browser: Browser, width: int
) -> None:
    hidden = browser.value("(b => b.scrollWidth - b.clientWidth)(document.querySelector('.scroll'))")
    assert (hidden == 0) == (width == 1280)


def test_hostile_names_are_text_and_do_not_run(browser: Browser, width: int) -> None:
    assert browser.value(f"{STATE}.owned === undefined")
    assert browser.value("document.querySelector('h1').textContent") == HOSTILE


def test_log_scale_can_be_switched_on_and_off(browser: Browser, width: int) -> None:
    for kind in ("log", "linear"):
        browser.value("document.querySelector('button[data-log-scale]').click()")
        assert browser.value("document.getElementById('figure-error-position').layout.yaxis.type") == kind
