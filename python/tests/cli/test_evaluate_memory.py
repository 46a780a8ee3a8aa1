# SPDX-License-Identifier: Apache-2.0
"""`slipwise evaluate --memory`: the table of surfaces, the prediction file, the exit code."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import EDD_2, Result
from sample_logs import Drive, simulated_log

from slipwise.logs import save_log

Slipwise = Callable[..., Result]


@pytest.fixture
def logs(folder: Path) -> list[Path]:
    paths = [folder / f"drive{seed}.csv" for seed in range(2)]
    for seed, path in enumerate(paths):
        save_log(simulated_log(Drive(seconds=60.0, seed=seed, basis=EDD_2, alpha=(-0.1, -0.4))), path)
    return paths


def test_surfaces_and_predictions_of_a_sequence_are_written(
    slipwise: Slipwise, folder: Path, logs: list[Path]
) -> None:
    written = folder / "p.csv"
    result = slipwise(
        *("evaluate", "--memory", *logs, "--input", "wheel", "--horizons", "1"),
        *("--predictions", written, "--json", "-"),
    )
    assert result.code == 0
    document = result.json
    assert [log["surface"] for log in document["logs"]] == ["surface 1", "surface 1"]
    assert document["surfaces"][0]["visits"] == 2
    with written.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["log"] for row in rows} == {"0", "1"}
    assert {row["method"] for row in rows} == {"none", "auto"}
