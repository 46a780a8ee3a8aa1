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
    first = slipwise(*LEARN, *logs[:2], "-o", monday, "--surface", "hall", "--surface", "sand")
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


@pytest.mark.slow
def test_a_table_of_labels_teaches_what_is_said_on_which_surface(
    slipwise: Slipwise, folder: Path, logs: list[Path]
) -> None:
    labels, model = folder / "labels.csv", folder / "model.yaml"
    rows = [
        f"drive {run},{t},{t + 5},{name},{white},{1 - white},0.0"
        for run, (name, white) in enumerate((("white", 0.9), ("brown", 0.1), ("white", 0.9)))
        for t in range(0, 55, 5)
    ]
    labels.write_text("\n".join(("run,t_start,t_end,label,p_white,p_brown,p_unknown", *rows)) + "\n")
    assert slipwise(*LEARN, *logs, "-o", model, "--surface", labels).code == 0
    firm, loose = load_model(model).content.surfaces
    assert firm.classes["white"] > firm.classes["brown"]
    assert loose.classes["brown"] > loose.classes["white"]
    again = slipwise(*LEARN, model, logs[0], "--surface", labels, "--json", "-").json
    assert again["visits"][0]["surface"] == firm.name
    assert "cannot be mixed" in slipwise(*LEARN, logs[0], "--surface", labels, "--surface", "hall").line
    assert "replace what is read" in slipwise(*LEARN, logs[0], "--surface", labels, "-o", labels).line
    assert "the labels are of runs x" in slipwise(*LEARN, logs[0], "--surface", _of_another_run(folder)).line


def _of_another_run(folder: Path) -> Path:
    path = folder / "other.csv"
    path.write_text("run,t_start,t_end,label\nx,0,5,ice\n")
    return path


def test_what_contradicts_itself_is_refused(slipwise: Slipwise, folder: Path, logs: list[Path]) -> None:
    assert "add --memory" in slipwise("calibrate", logs[0], "--surface", "sand").line
    assert "add --memory" in slipwise("evaluate", logs[0], "--surface", "sand").line
    assert "smoothing is over one surface" in slipwise(*LEARN, logs[0], "--set", "smoothing.smooth=true").line
    assert "no log given" in slipwise(*LEARN, folder / "m.yaml").line
    assert (
        "only one model can be continued"
        in slipwise(*LEARN, folder / "a.yaml", folder / "b.yaml", logs[0]).line
    )
    assert "2 labels for 3 logs" in slipwise(*LEARN, *logs, "--surface", "a", "--surface", "b").line
