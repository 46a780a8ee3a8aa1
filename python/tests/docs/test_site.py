# SPDX-License-Identifier: Apache-2.0
"""The pages become a site without a warning, and every page of its menu is there."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
import yaml
from docs.site_links import for_site
from python.tests.docs.pages import ROOT
from reporting.browser import Browser

SETTINGS = ROOT / "mkdocs.yml"


class MenuLoader(yaml.SafeLoader):
    """Reads the settings of the site; what names a Python function is of no interest here."""


MenuLoader.add_multi_constructor("tag:yaml.org,2002:python/", lambda loader, suffix, node: suffix)


class Targets(HTMLParser):
    """The targets of a page's links."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "a":
            self.found += [value for name, value in attrs if name == "href" and value]


def pages_of(menu: Any) -> Iterator[str]:
    if isinstance(menu, str):
        yield menu
    elif isinstance(menu, dict):
        for part in menu.values():
            yield from pages_of(part)
    else:
        for part in menu:
            yield from pages_of(part)


def menu_pages() -> list[str]:
    settings = yaml.load(SETTINGS.read_text(encoding="utf-8"), Loader=MenuLoader)  # noqa: S506
    return list(pages_of(settings["nav"]))


def html_of(page: str) -> str:
    return (
        f"{page.removesuffix('README.md')}index.html" if page.endswith("README.md") else f"{page[:-3]}.html"
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_every_page_below_docs_is_in_the_menu() -> None:
    pages = {str(path.relative_to(ROOT / "docs")) for path in (ROOT / "docs").rglob("*.md")}
    assert pages <= set(menu_pages())


def test_links_to_files_outside_the_site_become_text() -> None:
    text = "[a](../cpp/x.hpp), [b](../ARCHITECTURE.md#layers), [c](derivations.md), [d](https://example.org)"
    expected = "a (`cpp/x.hpp`), [b](ARCHITECTURE.md#layers), [c](derivations.md), [d](https://example.org)"
    assert for_site(text, "statistics.md") == expected
    assert for_site("[s](docs/statistics.md)", "index.md") == "[s](statistics.md)"
    assert for_site("```\n[a](x.py)\n```", "index.md") == "```\n[a](x.py)\n```"


@pytest.mark.slow
def test_every_page_of_the_menu_has_html(site: Path) -> None:
    missing = [page for page in menu_pages() if not (site / html_of(page)).is_file()]
    assert not missing


@pytest.mark.slow
def test_links_of_the_site_lead_to_files(site: Path) -> None:
    broken = []
    for page in menu_pages():
        path = site / html_of(page)
        for target in Targets(path.read_text(encoding="utf-8")).found:
            file = target.partition("#")[0]
            if file and "://" not in target and not (path.parent / file).exists():
                broken.append((page, target))
    assert not broken


@pytest.mark.slow
def test_reference_has_the_docstrings(site: Path) -> None:
    text = (site / "reference.html").read_text(encoding="utf-8")
    for name in ("slipwise.calibrate", "slipwise.MotionLearner", "slipwise.planning.rollout.rollout"):
        assert f'id="{name}"' in text


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 400])
def test_site_fits_a_screen_and_is_searched(browser: Browser, site: Path, width: int) -> None:
    page = site / "which-log.html"
    page.write_text(
        page.read_text(encoding="utf-8").replace("<html", '<html data-ready="yes"'), encoding="utf-8"
    )
    browser.open(page, width=width)
    browser.wait_for("document.readyState == 'complete'")
    assert browser.value("document.documentElement.scrollWidth") == width
    assert browser.problems == []
    assert not [url for url in browser.requests if not url.startswith(("file:", "data:"))]
    browser.value("document.querySelector('#__search').click()")
    browser.value(
        "(() => { const field = document.querySelector('.md-search__input'); field.focus();"
        " field.value = 'embargo'; field.dispatchEvent(new Event('keyup')); })()"
    )
    browser.wait_for("document.querySelectorAll('.md-search-result__item').length > 0")
