# SPDX-License-Identifier: Apache-2.0
"""Rows that stand for learned ones are distinct, and the driver's steps are measured on them."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest
from fleet.work_samples import sample_rows
from fleet_scale import LOGS_OF_A_VEHICLE, TEMPLATES, cached_work, measure_driver

from slipwise.fleet import LogTask


def _templates(folder: Path) -> Path:
    path = folder / "rows.json"
    path.write_text(json.dumps([asdict(sample_rows())]), encoding="utf-8")
    return path


def test_rows_that_are_handed_out_differ_by_no_more_than_they_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(TEMPLATES, str(_templates(tmp_path)))
    rows = [cached_work(LogTask(f"v/{k}.csv", "v", "", f"{k:064x}"[::-1])) for k in range(40)]
    assert len({each.key for each in rows}) == 40
    off = [(each.rows[0].value + 0.3) / 0.01 for each in rows]
    assert 0.6 < sum(value**2 for value in off) / 40 < 1.5


@pytest.mark.slow
def test_steps_of_the_driver_are_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    paths = (Path(__file__).parents[3] / "benchmarks", Path(__file__).parents[1])
    monkeypatch.setenv("PYTHONPATH", ":".join(map(str, paths)))  # of the workers
    steps = measure_driver(3 * LOGS_OF_A_VEHICLE, _templates(tmp_path))
    assert steps["logs"] == 150
    for name in ("learn", "table", "findings", "page", "prior", "again"):
        step = steps[name]
        assert isinstance(step, dict)
        assert step["peak_mb"] > 10.0
