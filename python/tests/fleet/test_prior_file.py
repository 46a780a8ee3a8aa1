# SPDX-License-Identifier: Apache-2.0
"""The prior file says of each parameter what the next robot's is likely to be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from fleet.test_findings import table_of

from slipwise.fleet import findings_of, write_prior


def test_file_holds_mean_and_spread_of_the_next_robot(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    values = {f"robot-{k}": np.full(4, random.normal(-0.1, 0.05)) for k in range(40)}
    path = write_prior(tmp_path / "fleet.yaml", findings_of(table_of(values, np.arange(4.0))))
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    parameter = content["parameters"]["lon.V"]
    assert content["slipwise_fleet_prior"] == 2
    assert parameter["robots"] == 40
    assert parameter["mean"] == pytest.approx(-0.1, abs=0.03)
    assert 0.02 < parameter["std"] < 0.08


def test_single_vehicle_gives_no_parameter(tmp_path: Path) -> None:
    table = table_of({"one": np.array([-0.1, -0.1])}, np.arange(2.0))
    path = write_prior(tmp_path / "fleet.yaml", findings_of(table))
    assert yaml.safe_load(path.read_text(encoding="utf-8"))["parameters"] == {}
