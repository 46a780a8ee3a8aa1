# SPDX-License-Identifier: Apache-2.0
"""The page of drives in turn, also in a headless Chromium without network."""

from __future__ import annotations

from pathlib import Path

import pytest
from reporting.browser import Browser
from reporting.page_layout import overlaps
from reporting.page_parts import figures_of, headings_of
from reporting.page_privacy import assert_sends_nothing
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.evaluation import EvaluationOptions, evaluate_sequence
from slipwise.reporting.sequence_page import sequence_page, write_sequence_page

EDD_2 = _core.named_basis("edd-2")
STATE = "document.documentElement.dataset"


@pytest.fixture(scope="module")
def page() -> str:
    slips = ((-0.02, -0.1), (-0.2, -0.5), (-0.02, -0.1))
    logs = [
        simulated_log(Drive(seconds=80.0, seed=seed, basis=EDD_2, alpha=slip))
        for seed, slip in enumerate(slips)
    ]
    named = [(f"<{place}>.csv", log) for place, log in enumerate(logs)]
    options = EvaluationOptions(horizons=(1.0,))
    return sequence_page(logs, evaluate_sequence(named, input="wheel", options=options), title="<drives>")


def test_the_strip_names_each_surface_as_the_bank_does(page: str) -> None:
    data = figures_of(page)["figure-ground"]["data"]
    first, second = (trace for trace in data[:-1] if max(trace["y"]) > 0.99)
    assert (first["name"], second["name"]) == ("surface 1", "surface 2")
    assert first["y"][0] > 0.99
    assert first["y"][-1] > 0.99
    assert any("surface 1 recalled" in text for text in data[-1]["text"])


def test_a_reader_finds_surfaces_and_visits(page: str) -> None:
    assert headings_of(page) == [
        "Which ground the robot was on",
        "The surfaces that are remembered",
        "Each visit",
        "How to make this again",
    ]
    assert "&lt;0&gt;.csv" in page
    assert "<0>.csv" not in page


def test_the_page_is_written_whole(tmp_path: Path) -> None:
    log = simulated_log(Drive(seconds=30.0))
    sequence = evaluate_sequence([("a.csv", log)], input="wheel", options=EvaluationOptions(horizons=(1.0,)))
    written = write_sequence_page(
        tmp_path / "new" / "page.html", [log], sequence, title="x", command="slipwise x"
    )
    assert "slipwise x" in written.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 420])
def test_the_page_is_drawn_without_error_and_fits_the_width(
    browser: Browser, page: str, tmp_path: Path, width: int
) -> None:
    path = tmp_path / "page.html"
    path.write_text(page, encoding="utf-8")
    browser.open(path, width=width)
    assert browser.value(f"{STATE}.errors") == ""
    assert browser.problems == []
    assert browser.value("document.documentElement.scrollWidth") <= width
    assert overlaps(browser) == []
    assert_sends_nothing(browser, path)
