# SPDX-License-Identifier: Apache-2.0
"""`slipwise demo` ends with the table that it is for, and with the paths of what it wrote."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result

pytest.importorskip("mujoco")


@pytest.mark.slow
def test_the_demo_ends_with_its_table_and_paths(slipwise: Callable[..., Result], folder: Path) -> None:
    result = slipwise("demo", "--output", "shown", "--duration", "90")
    assert (result.code, result.err) == (0, "")
    for method in ("none ", "vendor, separation x 1.875", "edd-2", "slipwise"):
        assert f"\n  {method}" in result.out
    for head in ("position [m], 2 s", "heading [deg], 2 s", "position [m], 5 s", "heading [deg], 5 s"):
        assert head in result.out
    for name in ("drive.mcap", "model.yaml", "report.html", "settings.toml", "result.json"):
        assert f"shown/{name}" in result.out
        assert Path("shown", name).stat().st_size > 0
    assert not Path("runs").exists()


def test_a_demo_too_short_to_learn_from_leaves_nothing(slipwise: Callable[..., Result], folder: Path) -> None:
    result = slipwise("demo", "--duration", "30")
    assert result.code == 2
    assert result.line == "the demonstration lasts 30 s (--duration): give at least 60 s to learn from"
    assert list(folder.iterdir()) == []
