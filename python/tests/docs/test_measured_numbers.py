# SPDX-License-Identifier: Apache-2.0
"""Figures of a benchmark that a page repeats are those of the newest report."""

from __future__ import annotations

import json
from typing import Any

from python.tests.docs.pages import ROOT, table_rows

SOON = 3  # windows that turn, within which a change counts as found


def newest(name: str) -> Any:
    """Return the raw figures of a benchmark from the newest report that has them."""
    *_, file = sorted((ROOT / "benchmarks/reports").glob(f"*/{name}.json"))
    return json.loads(file.read_text(encoding="utf-8"))


def test_how_soon_a_change_of_ground_is_found_is_as_measured() -> None:
    page = (ROOT / "docs/derivations.md").read_text(encoding="utf-8")
    section = page[page.index("## 17. Change of terrain") : page.index("## 18.")]
    figures = newest("terrain_change")
    rows = table_rows(section, "| yaw slip times |")
    assert [row[0] for row in rows] == ["1.5", "1.25"]
    for factor, *found in rows:
        for source, count in zip(("wheel", "command"), found, strict=True):
            windows = figures["steps"][f"{source} x{factor}"]
            assert len(windows) == 20
            assert int(count) == sum(late is not None and late <= SOON for late in windows), (source, factor)
    rates = []
    for name in ("white", "heavy-tailed", "coloured"):
        runs = [run for run in figures["one_ground"] if run["name"] == name]
        rates.append(1000.0 * sum(run["alarms"] for run in runs) / sum(run["windows"] for run in runs))
    white, heavy, coloured = (f"{rate:.2f}" for rate in rates)
    real = [sum(run[key] for run in figures["real"]) for key in ("alarms", "windows")]
    plain = " ".join(section.split())
    assert f"{white}, {heavy} and {coloured} alarms per 1000 windows" in plain
    assert f"The real logs have {real[0]} alarms in {real[1]} windows" in plain
