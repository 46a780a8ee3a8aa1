# SPDX-License-Identifier: Apache-2.0
"""`slipwise compare` says what differs between two models, and which predicts a log better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_models import make_model, named

Slipwise = Callable[..., Result]


@pytest.fixture
def models(folder: Path) -> tuple[Path, Path]:
    """Models of the drive in `drive_csv` from wheel speeds: one that is right, and one that is not."""
    right, wrong = named("edd-2", lon__V=-0.1, ang__w=-0.3), named("edd-2", lon__V=-0.1, ang__w=-0.1)
    return make_model(right).save(folder / "right.yaml"), make_model(wrong).save(folder / "wrong.yaml")


def test_differences_stand_with_both_values_and_z(slipwise: Slipwise, models: tuple[Path, Path]) -> None:
    result = slipwise("compare", *models)
    assert (result.code, result.err) == (0, "")
    assert "2 of 5 numbers agree within 3 standard deviations." in result.out
    assert "ang.w by 14.1" in next(line for line in result.out.splitlines() if line.startswith("Different"))
    row = next(line for line in result.out.splitlines() if line.strip().startswith("ang.w"))
    assert row.split() == [
        "ang.w",
        "-0.300",
        "±",
        "0.010",
        "-0.100",
        "±",
        "0.010",
        "rad/s",
        "per",
        "w",
        "+14.1",
    ]
    assert "Both have learned from the same log" in result.out


def test_an_input_that_the_models_do_not_answer_from_is_refused(
    slipwise: Slipwise, models: tuple[Path, Path]
) -> None:
    result = slipwise("compare", *models, "--input", "command")
    assert result.code == 2
    assert "the model was learned from wheel speeds, and nothing from commands" in result.err


def test_a_log_decides_which_predicts_better(
    slipwise: Slipwise, drive_csv: Path, models: tuple[Path, Path]
) -> None:
    result = slipwise("compare", *models, drive_csv, "--json", "out.json")
    assert result.code == 0
    said = "wrong.yaml predicts this robot worse than right.yaml: after 5 s its position error is "
    assert result.out.lstrip().startswith(said)
    document = slipwise("compare", *models, drive_csv, "--json", "-").json
    assert document["predictions"]["better"] == "right.yaml"
    assert document["predictions"]["position"][1] > 1.0
    assert [each["horizon"] for each in document["predictions"]["horizons"]] == [1.0, 2.0, 5.0]
    assert document["predictions"]["sentences"][0] in result.out.replace("\n", " ")
    swapped = slipwise("compare", *reversed(models), drive_csv)
    assert swapped.out.lstrip().startswith("right.yaml predicts this robot better than wrong.yaml: after 5 s")
    assert [row["name"] for row in document["differences"] if row["different"]]


def test_logs_are_pooled_and_a_model_of_one_of_them_is_said_to_be(
    slipwise: Slipwise, folder: Path, drive_csv: Path, models: tuple[Path, Path]
) -> None:
    """Segments of two logs count together; one cannot be compared on what it learned without a word."""
    again, (head, *lines) = folder / "again.csv", drive_csv.read_text().splitlines()
    assert head.startswith("t,")
    cells = (line.partition(",") for line in lines)
    later = [f"{float(t) + 1000.0:.6f},{rest}" for t, _, rest in cells]  # the same drive is refused
    again.write_text("\n".join((head, *later)) + "\n")
    one = slipwise("compare", *models, drive_csv, "--json", "-").json["predictions"]
    two = slipwise("compare", *models, drive_csv, again, "--json", "-").json["predictions"]
    assert two["windows"] == 2 * one["windows"]
    assert two["position"][0] == pytest.approx(one["position"][0])
    assert two["learned_from_this"] == []
    assert slipwise("calibrate", drive_csv, "-o", "new.yaml", "--input", "wheel", "--no-report").code == 0
    own = slipwise("compare", models[1], "new.yaml", again, drive_csv)
    assert "new.yaml was learned from this log, which favours it" in own.out


def test_models_that_cannot_be_compared_are_one_line(
    slipwise: Slipwise, folder: Path, models: tuple[Path, Path]
) -> None:
    other = make_model(replace(named("edd-2"), commands=True)).save(folder / "commands.yaml")
    result = slipwise("compare", models[0], other)
    assert result.code == 2
    assert "one model was learned from wheels, the other from commands" in result.line
    assert slipwise("compare", models[0], models[0]).line.startswith("a model file is given twice")
