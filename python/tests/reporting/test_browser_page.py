# SPDX-License-Identifier: Apache-2.0
"""The page in a headless Chromium without network, at the widths of a desk and of a phone, light and dark."""

from __future__ import annotations

from pathlib import Path

import pytest
from reporting.browser import SCREEN_HEIGHT, Browser
from reporting.page_layout import overlaps, unfold, wait_for_figures
from reporting.page_parts import figures_of
from reporting.page_privacy import assert_sends_nothing
from reporting.synthetic_results import make_results

from slipwise.reporting import write_report
from slipwise.reporting.dark_colours import DARK

pytestmark = pytest.mark.slow

STATE = "document.documentElement.dataset"
HOSTILE = '</script><script>document.documentElement.dataset.owned = "yes"</script><b>'
DESK, PHONE = 1400, 420
MOST_UNFOLDED = 4000  # px high on a desk
SCALE = "document.getElementById('figure-error-position').layout.yaxis.type"
HEIGHT = "document.documentElement.scrollHeight"


def _report(folder: Path, *, runs: int, name: str) -> Path:
    results = make_results(runs=runs, run_name=name)
    parts = {"log": results.log, "calibration": results.calibration, "evaluation": results.evaluation}
    return write_report(folder / "report.html", **parts, title=name, command=name)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _report(tmp_path_factory.mktemp("report"), runs=2, name=HOSTILE)


@pytest.fixture(scope="module", params=[DESK, PHONE])
def width(request: pytest.FixtureRequest, browser: Browser, page: Path) -> int:
    """Show the page at a width [px]."""
    browser.open(page, width=request.param)
    return int(request.param)


def test_answer_is_one_screen_and_all_else_is_folded(browser: Browser, width: int) -> None:
    assert browser.value("document.querySelectorAll('details[open]').length") == 0
    assert browser.value(f"{STATE}.drawn") == "1"
    path = browser.value("document.querySelector('.plot[data-drawn]').getBoundingClientRect().bottom")
    assert path <= (SCREEN_HEIGHT if width == DESK else 1.5 * SCREEN_HEIGHT)
    bottom = browser.value("document.getElementById('section-1').getBoundingClientRect().bottom")
    assert bottom <= (SCREEN_HEIGHT if width == DESK else 2 * SCREEN_HEIGHT)
    assert overlaps(browser) == []


def test_a_section_draws_its_figures_when_it_is_opened_and_no_others(browser: Browser, width: int) -> None:
    browser.value("document.querySelector('#figure-error-position').closest('details').open = true")
    browser.wait_for(f"{STATE}.drawn === '3'")
    drawn = browser.value("Array.from(document.querySelectorAll('.plot[data-drawn]')).map(p => p.id)")
    assert drawn[1:] == ["figure-error-position", "figure-error-heading"]


def test_log_scale_can_be_switched_on_and_off(browser: Browser, width: int) -> None:
    browser.value("document.querySelector('#figure-error-position').closest('details').open = true")
    wait_for_figures(browser)
    for kind in ("log", "linear"):
        browser.value("document.querySelector('button[data-log-scale]').click()")
        browser.wait_for(f"{SCALE} === '{kind}'")


def test_unfolded_all_figures_are_drawn_without_error_or_request(
    browser: Browser, page: Path, tmp_path: Path, width: int
) -> None:
    unfold(browser)
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert [url for url in browser.requests if not url.startswith("data:")] == [page.as_uri()]
    names = list(figures_of(page.read_text(encoding="utf-8")))
    assert browser.value(f"{STATE}.drawn") == str(len(names))
    drawn = browser.value(
        "Array.from(document.querySelectorAll('.plot')).filter(p => p.querySelector('.main-svg, canvas')"
        " && p.getBoundingClientRect().width > 200).map(p => p.id)"
    )
    assert drawn == names
    pictures = browser.screenshots(tmp_path, f"report-{width}")
    assert all(picture.stat().st_size > 5000 for picture in pictures[:-1])


def test_unfolded_nothing_overlaps_and_the_page_never_scrolls_sideways(browser: Browser, width: int) -> None:
    assert overlaps(browser) == []
    assert browser.value("document.documentElement.scrollWidth") == width
    wide = browser.value(
        "Array.from(document.querySelectorAll('main *'))"
        ".filter(e => !e.closest('.scroll, pre, .plot'))"
        f".filter(e => e.getBoundingClientRect().right > {width} + 1).map(e => e.tagName + '.' + e.className)"
    )
    assert wide == []


def test_table_of_scores_fits_a_desktop_and_scrolls_in_its_box_on_phones(
    browser: Browser, width: int
) -> None:
    hidden = browser.value("(b => b.scrollWidth - b.clientWidth)(document.querySelector('.scroll'))")
    assert (hidden == 0) == (width == DESK)


def test_hostile_names_are_text_and_do_not_run(browser: Browser, width: int) -> None:
    assert browser.value(f"{STATE}.owned === undefined")
    assert browser.value("document.querySelector('h1').textContent") == HOSTILE


def test_no_button_sends_anything(browser: Browser, page: Path) -> None:
    browser.open(page, width=DESK)
    unfold(browser)
    assert_sends_nothing(browser, page)


def test_a_log_scale_that_is_asked_for_before_its_figure_is_drawn_is_drawn(
    browser: Browser, page: Path
) -> None:
    browser.open(page, width=DESK)
    browser.value("document.querySelector('button[data-log-scale]').click()")
    unfold(browser)
    assert browser.value(SCALE) == "log"
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []


def test_the_button_unfolds_every_section_into_a_few_screens_and_folds_them(
    browser: Browser, tmp_path: Path
) -> None:
    browser.open(_report(tmp_path, runs=1, name="field"), width=DESK)
    folded = browser.value(HEIGHT)
    browser.value("document.querySelector('button[data-unfold]').click()")
    assert browser.value("document.querySelectorAll('details.section:not([open])').length") == 0
    wait_for_figures(browser)
    assert browser.value(HEIGHT) <= MOST_UNFOLDED
    browser.value("document.querySelector('button[data-unfold]').click()")
    assert browser.value(HEIGHT) == folded


def test_page_and_figures_are_dark_where_the_browser_asks_for_it_and_change_with_it(
    browser: Browser, page: Path
) -> None:
    font = "document.getElementById('figure-error-position').layout.font.color"
    paper = "getComputedStyle(document.querySelector('section')).backgroundColor"
    key = "getComputedStyle(document.querySelector('.legend .key')).color"
    try:
        browser.prefer("dark")
        browser.open(page, width=DESK)
        browser.value("document.querySelector('#figure-error-position').closest('details').open = true")
        browser.wait_for(f"{STATE}.drawn === '3'")
        assert browser.value(font) == DARK["#1b2430"]
        assert browser.value(paper) == _rgb(DARK["#ffffff"])
        assert browser.value(key) == _rgb(DARK["#1b2430"])
        browser.value("document.querySelector('#figure-contours-forward').closest('details').open = true")
        wait_for_figures(browser)
        middle = "document.getElementById('figure-contours-forward').data[0].colorscale[2][1]"
        assert browser.value(middle) == DARK["#f7f7f7"]
        browser.prefer("light")
        browser.wait_for(f"{font} === '#1b2430'")
        assert browser.value(paper) == _rgb("#ffffff")
        assert browser.value(f"{STATE}.errors") == ""
    finally:
        browser.prefer("light")


def _rgb(colour: str) -> str:
    return f"rgb({', '.join(str(int(colour[i : i + 2], 16)) for i in (1, 3, 5))})"
