# SPDX-License-Identifier: Apache-2.0
"""The live page in a real browser, at the widths of a desk and of a phone: it shows, follows and is safe."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from live.sample_outputs import driven_outputs, driven_status, next_moves, waiting_status
from reporting.browser import Browser

from slipwise.live.outputs import Note, Status
from slipwise.live.watch.web_page import WebPage

pytest.importorskip("uvicorn")
pytest.importorskip("starlette")
pytestmark = pytest.mark.slow

STATE = "document.documentElement.dataset"
HOSTILE = '<img src=x onerror="document.documentElement.dataset.owned = 1"></script><script>alert(1)</script>'
DESK, PHONE = 1440, 390


@pytest.fixture
def page() -> Iterator[WebPage]:
    opened = WebPage()
    yield opened
    opened.close()


@pytest.fixture(params=[DESK, PHONE])
def width(request: pytest.FixtureRequest) -> int:
    return int(request.param)


def _text(browser: Browser, name: str) -> str:
    return str(browser.value(f"document.getElementById('{name}').textContent"))


def _show(browser: Browser, page: WebPage, width: int) -> None:
    browser.connect(True)
    browser.go(page.url, width=width)
    browser.wait_for(f"document.getElementById('log') !== null && {STATE}.updates !== undefined")


def _updates(browser: Browser, least: int) -> None:
    browser.wait_for(f"Number({STATE}.updates) >= {least}")


def _take_drive(page: WebPage) -> Status:
    for output in (*driven_outputs(), next_moves()):
        page.take(output)
    return driven_status()


def test_a_drive_is_shown_without_error_and_without_scrolling_sideways(
    browser: Browser, page: WebPage, width: int, tmp_path: Path
) -> None:
    status = _take_drive(page)
    _show(browser, page, width)
    _updates(browser, 1)
    assert _text(browser, "vehicle") == status.vehicle
    assert _text(browser, "state") == status.state
    assert _text(browser, "validity") == f"model: {status.validity}"
    assert _text(browser, "segments") == str(status.segments)
    rows = browser.value("Array.from(document.querySelectorAll('#parameters tbody tr td.name')).length")
    assert rows == len(status.parameters)
    assert browser.value("document.querySelectorAll('#moves svg.move').length") == 3
    assert "turning right 0.80 rad/s" in _text(browser, "moves")
    full = "Array.from(document.querySelectorAll('#sure .rail')).map(r => r.classList.contains('full'))"
    assert browser.value(full) == [False, True]
    drawn = "Array.from(document.querySelectorAll('.plot')).map(p => p.querySelectorAll('.trace').length)"
    assert all(count > 0 for count in browser.value(drawn))
    assert browser.problems == []
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.value("document.documentElement.scrollWidth") == width
    hidden = browser.value(
        "Array.from(document.querySelectorAll('main *')).filter(e => !e.closest('svg'))"
        f".filter(e => e.getBoundingClientRect().right > {width} + 1).map(e => e.tagName + '.' + e.className)"
    )
    assert hidden == []
    assert {url.partition("?")[0] for url in browser.requests if not url.startswith("data:")} == {
        page.url + name for name in ("", "live.css", "plotly.js", "live.js", "events")
    }
    assert all(p.stat().st_size > 5000 for p in browser.screenshots(tmp_path, f"live-{width}")[:-1])


def test_what_changes_is_followed(browser: Browser, page: WebPage) -> None:
    status = _take_drive(page)
    _show(browser, page, DESK)
    _updates(browser, 1)
    first = replace(status.parameters[0], value=-0.4321, std=0.0012, validity="invalid")
    counts = {"operator drives": 12_345}
    changed = replace(
        status,
        t=status.t + 1.0,
        state="stuck",
        why="the wheels turn",
        parameters=(first, *status.parameters[1:]),
        counts=counts,
        log=((1.0, "stuck"),),
    )
    page.take(changed)
    browser.wait_for("document.getElementById('state').textContent === 'stuck'")
    assert _text(browser, "why") == "the wheels turn"
    row = "document.querySelector('#parameters tbody tr')"
    assert browser.value(f"{row}.querySelector('.value').textContent") == "−0.4321 ± 0.0012"
    assert browser.value(f"{row}.querySelector('.validity').className") == "validity bad"
    assert browser.value("document.querySelector('#counts tbody').textContent") == "operator drives12,345"
    assert "stuck" in _text(browser, "log")


def test_waiting_is_shown_before_anything_is_known(browser: Browser, page: WebPage, width: int) -> None:
    _show(browser, page, width)
    browser.wait_for(f"{STATE}.connection === 'quiet'")
    page.take(Note(1.0, "nothing comes on /odom"))
    browser.wait_for("document.getElementById('log').textContent.includes('nothing comes on /odom')")
    page.take(waiting_status())
    browser.wait_for("document.getElementById('why').textContent === 'no pose yet'")
    assert "Nothing was learned yet." in _text(browser, "parameters")
    assert browser.problems == []
    assert browser.value("document.documentElement.scrollWidth") == width


def test_names_from_the_robot_are_text_and_never_run(browser: Browser, page: WebPage, width: int) -> None:
    status = driven_status()
    parameter = replace(status.parameters[0], name=HOSTILE, unit=HOSTILE)
    page.take(
        replace(
            status,
            vehicle=HOSTILE,
            why=HOSTILE,
            validity_why=HOSTILE,
            parameters=(parameter,),
            counts={HOSTILE: 1},
            log=((0.0, HOSTILE),),
        )
    )
    page.take(next_moves(moves=tuple(replace(move, teaches=HOSTILE) for move in next_moves().moves)))
    _show(browser, page, width)
    _updates(browser, 1)
    for name in ("vehicle", "why", "validity-why", "log", "counts", "parameters", "moves"):
        assert HOSTILE in _text(browser, name)
    assert browser.value(f"{STATE}.owned === undefined && document.querySelector('img') === null")
    assert browser.value("document.querySelectorAll('script').length") == 2
    assert browser.problems == []
    assert browser.value("document.documentElement.scrollWidth") == width


def test_a_lost_stream_is_said_and_found_again(browser: Browser) -> None:
    page = WebPage()
    page.take(waiting_status(why="before"))
    _show(browser, page, DESK)
    _updates(browser, 1)
    page.close()
    browser.wait_for(f"{STATE}.connection === 'lost'")
    assert "connection lost" in _text(browser, "connection-text")
    again = WebPage(port=page.port)
    try:
        again.take(waiting_status(why="after"))
        browser.wait_for("document.getElementById('why').textContent === 'after'")
        browser.wait_for(f"{STATE}.connection === 'live'")
    finally:
        again.close()


def test_a_node_that_says_nothing_is_told_from_a_lost_stream(browser: Browser, page: WebPage) -> None:
    page.take(waiting_status())
    _show(browser, page, DESK)
    browser.wait_for(f"{STATE}.connection === 'quiet'")
    assert _text(browser, "connection-text").startswith("nothing new for ")


def test_the_figure_follows_the_robot_when_asked(browser: Browser, page: WebPage) -> None:
    _take_drive(page)
    _show(browser, page, DESK)
    _updates(browser, 1)
    browser.value("document.getElementById('follow').click()")
    span = "(r => r[1] - r[0])(document.getElementById('path').layout.yaxis.range)"
    browser.wait_for(f"Math.abs({span} - 6) < 0.1")


def test_a_page_beyond_this_machine_works_with_its_token(browser: Browser) -> None:
    page = WebPage(host="0.0.0.0")
    try:
        page.take(waiting_status(why="with token"))
        browser.connect(True)
        browser.go(f"http://127.0.0.1:{page.port}/?token={page.token}", width=PHONE)
        browser.wait_for("document.getElementById('why')?.textContent === 'with token'")
        assert browser.problems == []
    finally:
        page.close()


def test_dark_figures_follow_the_browser(browser: Browser, page: WebPage) -> None:
    _take_drive(page)
    font = "document.getElementById('path').layout?.font?.color"
    try:
        browser.prefer("dark")
        _show(browser, page, DESK)
        browser.wait_for(f"{font} === '#e3e8ee'")
        browser.prefer("light")
        browser.wait_for(f"{font} === '#1b2430'")
    finally:
        browser.prefer("light")
