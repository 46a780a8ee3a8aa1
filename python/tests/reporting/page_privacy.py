# SPDX-License-Identifier: Apache-2.0
"""What every page that slipwise writes keeps to: no button sends anything, and nothing is fetched or sent."""

from __future__ import annotations

from pathlib import Path

from reporting.browser import Browser

# Their titles are looked at, not their names, since a title is what a reader sees.
HARMLESS = {
    "Download plot as a PNG",
    "Download plot as a png",
    "Zoom",
    "Pan",
    "Zoom in",
    "Zoom out",
    "Reset axes",
    "Orbital rotation",
    "Reset camera to default",
}
TITLES = "Array.from(document.querySelectorAll('.modebar-btn')).map(b => b.dataset.title)"
SERVERS = (
    "Array.from(document.querySelectorAll('.js-plotly-plot')).map(p => p._context.plotlyServerURL)"
    ".filter(url => url !== '')"
)
CLICKS = (
    "Array.from(document.querySelectorAll('.plot')).forEach(p => "
    "p.querySelectorAll('.modebar-btn:not([data-title*=Download])').forEach(b => b.click()))"
)


def assert_sends_nothing(browser: Browser, page: Path) -> None:
    """Look at every button of the page that is shown, use them, and see that no request was made."""
    titles = browser.value(TITLES)
    assert titles
    assert set(titles) <= HARMLESS
    assert browser.value(SERVERS) == []
    browser.value(CLICKS)
    assert browser.value("document.querySelectorAll('[class*=cloud]').length") == 0
    assert [url for url in browser.requests if not url.startswith(("data:", "blob:"))] == [page.as_uri()]
