# SPDX-License-Identifier: Apache-2.0
"""What tests of benchmarks fraction: their modules by name, and simulated logs in place of the real ones."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "benchmarks"))

LOGS = ("first/short", "second/long")


@pytest.fixture(scope="session")
def simulated_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with two logs of commands and wheel speeds."""
    from benchmarks.promises.disturbed_robot import Robot, disturbed_run

    from slipwise.logs import save_log

    folder = tmp_path_factory.mktemp("data")
    for seed, name in enumerate(LOGS):
        path = folder / f"{name}.csv.gz"
        path.parent.mkdir()
        save_log(disturbed_run(Robot(), 1.0 + seed, seed=seed).log, path)
    return folder


@pytest.fixture
def data(simulated_data: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the same, as SLIPWISE_DATA."""
    monkeypatch.setenv("SLIPWISE_DATA", str(simulated_data))
    return simulated_data
