# SPDX-License-Identifier: Apache-2.0
"""The page shows vehicles, alarms and unusable logs, and text of users as text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from fleet.test_findings import SIGMA, table_of
from reporting.browser import Browser

from slipwise.fleet import findings_of
from slipwise.fleet.fleet_page import fleet_page, summary
from slipwise.fleet.vehicle_numbers import NAMES, types_apart

UNUSABLE = [{"log": "<i>bad</i>.csv", "vehicle": "red", "failure": "no poses"}]


def sample_table() -> dict[str, np.ndarray]:
    """Return rows of five robots, the last of which is unlike the others."""
    random = np.random.default_rng(1)
    values = {f"robot-{k}": -0.1 + SIGMA * random.standard_normal(6) for k in range(4)}
    values["<b>odd</b>"] = 0.4 + SIGMA * random.standard_normal(6)
    table = table_of(values, np.arange(6.0))
    rows = len(table["value"])
    numbers = {name: np.full(rows, 0.5) for name in NAMES} | {"multiplier": np.full(rows, np.nan)}
    numbers["turns"] = np.where(table["vehicle"] == "<b>odd</b>", 0.8, 0.47 + 0.01 * random.random(rows))
    return (
        table
        | numbers
        | {
            "key": np.array([f"log-{k}" for k in range(rows)]),
            "good": np.ones(rows, dtype=bool),
            "seconds": np.full(rows, 600.0),
        }
    )


def test_page_names_the_odd_robot_as_text() -> None:
    table = sample_table()
    page = fleet_page(table, findings_of(table), UNUSABLE)
    assert "unlike the others" in page
    assert "&lt;b&gt;odd&lt;/b&gt;" in page
    assert "<b>odd</b>" not in page
    assert "<i>bad</i>" not in page
    assert "no poses" in page


def test_table_gives_an_engineer_s_numbers_first_and_warns_of_two_types() -> None:
    table = sample_table()
    page = fleet_page(table, findings_of(table), [])
    row = page[page.index('<th scope="row">robot-0</th>') :].partition("</tr>")[0]
    assert row.startswith(
        '<th scope="row">robot-0</th><td>50 %</td><td>48 %<small>47 to 48</small></td><td>–'
    )
    assert "6<small>6 good</small>" in row
    warning = types_apart(table)
    assert "&lt;b&gt;odd&lt;/b&gt; (turns 0.80)" in page
    assert warning.startswith("These look like two types of robot: robot-")
    assert page.index("two types of robot") < page.index("What stands out")


def test_one_type_whose_logs_differ_is_no_warning() -> None:
    table = sample_table()
    table["turns"] = np.where(table["vehicle"] == "<b>odd</b>", 0.55, table["turns"])
    assert types_apart(table) == ""
    table["turns"] = np.random.default_rng(2).uniform(0.3, 0.9, len(table["turns"]))
    assert types_apart(table) == ""


def test_charts_of_what_differs_most_come_first() -> None:
    random = np.random.default_rng(3)
    parts = []
    for name, spread in (("a", 0.0), ("log_delay_v", 0.5), ("z", 0.1)):
        values = {f"robot-{k}": spread * k + SIGMA * random.standard_normal(6) for k in range(3)}
        parts.append(table_of(values, np.arange(6.0)) | {"parameter": np.full(18, name)})
    table = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    rows = len(table["value"])
    table |= {name: np.full(rows, 0.5) for name in NAMES} | {"good": np.ones(rows, dtype=bool)}
    table |= {"key": np.array([f"log-{k}" for k in range(rows)]), "seconds": np.full(rows, 60.0)}
    page = fleet_page(table, findings_of(table), [])
    side = page[page.index("Vehicles side by side") : page.index("Over time")]
    assert re.findall(r"<h3>(.*?)</h3>", side) == ["delay_v", "z", "a"]


def test_summary_counts_logs_vehicles_hours_and_alarms() -> None:
    table = sample_table()
    text = " ".join(summary(table, findings_of(table), UNUSABLE))
    assert "30 logs of 5 vehicles, 5.00 h of driving; 30 with a good verdict." in text
    assert "1 log could not be used." in text
    assert re.search(r"\. 1 alarm of \d+ tests: \S+ (is unlike the others|drifts) in \S+\. A vehicle", text)


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
