# SPDX-License-Identifier: Apache-2.0
"""One absurd cell changes nothing but the count: the rest is learned as if the cell had been empty."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli.conftest import Columns, Result, write_csv

Slipwise = Callable[..., Result]


def learned(slipwise: Slipwise, columns: Columns, path: Path, source: str) -> dict[str, Any]:
    """Learn two numbers from the columns; return the document."""
    write_csv(path, columns)
    result = slipwise("calibrate", path, "--input", source, "--basis", "edd-2", "--no-report", "--json", "-")
    assert result.code == 0, result
    return result.json


def with_cell(columns: Columns, name: str, row: int, value: float) -> Columns:
    changed = {key: values.copy() for key, values in columns.items()}
    changed[name][row] = value
    return changed


SPEEDS = [
    (name, source, value, "absurd-speed")
    for name, source in (("cmd_v", "command"), ("odo_omega", "wheel"))
    for value in (90.0, -1e6, 1e15, 9.2e18)
]
POSES = [(name, "wheel", value, "pose-outlier") for name in ("x", "y", "yaw") for value in (1e3, -1e6, 1e15)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "source", "value", "kind"), [*SPEEDS, *POSES])
def test_an_absurd_cell_is_as_good_as_an_empty_one(
    slipwise: Slipwise, columns: Columns, folder: Path, name: str, source: str, value: float, kind: str
) -> None:
    spoilt = learned(slipwise, with_cell(columns, name, 700, value), folder / "drive.csv", source)
    empty = learned(slipwise, with_cell(columns, name, 700, np.nan), folder / "drive.csv", source)
    assert spoilt["parameters"] == empty["parameters"]
    assert spoilt["verdict"] == empty["verdict"]
    kinds = {entry["kind"]: entry["count"] for entry in spoilt["left_out"]}
    assert kinds[kind] == 1
