# SPDX-License-Identifier: Apache-2.0
"""`slipwise surfaces`, and `calibrate --memory` that writes and goes on from them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_surfaces import FIRM, LOOSE, floor_log

from slipwise.logs import save_log
from slipwise.models import load_model

Slipwise = Callable[..., Result]
LEARN = ("calibrate", "--memory", "--input", "wheel", "--no-report")


@pytest.fixture
def logs(folder: Path) -> list[Path]:
    paths = [folder / f"drive{seed}.csv" for seed in range(3)]
    for seed, (path, slip) in enumerate(zip(paths, (FIRM, LOOSE, FIRM), strict=True)):
        save_log(floor_log(slip, seed), path)
    return paths


@pytest.mark.slow
def test_surfaces_are_learned_gone_on_from_renamed_and_merged(
    slipwise: Slipwise, folder: Path, logs: list[Path]
) -> None:
    monday, tuesday, both = folder / "monday.yaml", folder / "tuesday.yaml", folder / "both.yaml"
    first = slipwise(*LEARN, *logs[:2], "-o", monday, "--terrain", "hall", "--terrain", "sand")
    assert first.code == 0
    assert "drive1.csv ended on sand." in first.out
    second = slipwise(*LEARN, monday, logs[2], "-o", tuesday, "--json", "-").json
    assert [visit["surface"] for visit in second["visits"]] == ["hall"]
    assert [surface["visits"] for surface in second["surfaces"]] == [2, 1]
    assert load_model(tuesday).content.surfaces[0].name == "hall"
    evaluated = slipwise(
        *("evaluate", "--memory", "--model", monday, logs[2], "--horizons", "1", "--json", "-"),
    ).json
    assert evaluated["logs"][0]["surface"] == "hall"
    listed = slipwise("surfaces", "list", monday)
    assert "hall" in listed.out
    assert "sand" in listed.out
    assert slipwise("surfaces", "rename", monday, "sand", "beach", "-o", folder / "b.yaml").code == 0
    merged = slipwise("surfaces", "merge", monday, folder / "b.yaml", "-o", both, "--json", "-").json
    became = {each["name"]: each["became"] for each in merged["merged"]}
    assert became == {"hall": "hall", "beach": "sand"}
    assert [each["name"] for each in merged["surfaces"]] == ["hall", "sand"]


def test_what_contradicts_itself_is_refused(slipwise: Slipwise, folder: Path, logs: list[Path]) -> None:
    assert "add --memory" in slipwise("calibrate", logs[0], "--terrain", "sand").line
    assert "add --memory" in slipwise("evaluate", logs[0], "--terrain", "sand").line
    assert "leave --smooth" in slipwise(*LEARN, logs[0], "--smooth").line
    assert "no log was given" in slipwise(*LEARN, folder / "m.yaml").line
    assert "from one model" in slipwise(*LEARN, folder / "a.yaml", folder / "b.yaml", logs[0]).line
    assert "2 labels for 3 logs" in slipwise(*LEARN, *logs, "--terrain", "a", "--terrain", "b").line
