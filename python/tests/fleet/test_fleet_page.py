# SPDX-License-Identifier: Apache-2.0
"""The page shows vehicles, alarms and unusable logs, and text of users as text."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fleet.test_findings import SIGMA, table_of
from reporting.browser import Browser

from slipwise.fleet import findings_of
from slipwise.fleet.fleet_page import fleet_page, summary

UNUSABLE = [{"log": "<i>bad</i>.csv", "vehicle": "red", "failure": "no poses"}]


def sample_table() -> dict[str, np.ndarray]:
    """Return rows of five robots, the last of which is unlike the others."""
    random = np.random.default_rng(1)
    values = {f"robot-{k}": -0.1 + SIGMA * random.standard_normal(6) for k in range(4)}
    values["<b>odd</b>"] = 0.4 + SIGMA * random.standard_normal(6)
    table = table_of(values, np.arange(6.0))
    rows = len(table["value"])
    return table | {
        "key": np.array([f"log-{k}" for k in range(rows)]),
        "good": np.ones(rows, dtype=bool),
        "seconds": np.full(rows, 600.0),
    }


def test_page_names_the_odd_robot_as_text() -> None:
    table = sample_table()
    page = fleet_page(table, findings_of(table), UNUSABLE)
    assert "unlike the others" in page
    assert "&lt;b&gt;odd&lt;/b&gt;" in page
    assert "<b>odd</b>" not in page
    assert "<i>bad</i>" not in page
    assert "no poses" in page


def test_summary_counts_logs_vehicles_hours_and_alarms() -> None:
    table = sample_table()
    text = " ".join(summary(table, findings_of(table), UNUSABLE))
    assert "30 logs of 5 vehicles, 5.00 h of driving; 30 with a good verdict." in text
    assert "1 logs could not be used." in text
    assert "1 alarms" in text


def test_fleet_without_rows_says_so() -> None:
    assert summary({}, (), UNUSABLE) == ["None of 1 logs could be used."]
    assert "no log that could be used" in fleet_page({}, (), UNUSABLE)


@pytest.mark.slow
def test_page_is_drawn_without_error(browser: Browser, tmp_path: Path) -> None:
    table = sample_table()
    path = tmp_path / "fleet.html"
    path.write_text(fleet_page(table, findings_of(table), UNUSABLE), encoding="utf-8")
    browser.open(path, width=1000)
    browser.value("document.querySelector('[data-unfold]').click()")
    assert browser.value("document.documentElement.dataset.errors") == ""
    assert browser.problems == []
