# SPDX-License-Identifier: Apache-2.0
"""`slipwise lattice` writes what Nav2 reads and what slip leaves of curvatures, or says what is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Result
from sample_models import make_model, named

Slipwise = Callable[..., Result]
SKIDDING = replace(named("edd-2", ang__w=-0.3), commands=True)


@pytest.fixture
def arguments(folder: Path) -> list[object]:
    """Write a model; return a quick lattice of it."""
    make_model(SKIDDING).save(folder / "model.yaml")
    return ["lattice", "model.yaml", "-o", "out/lattice", "--grid", "0.2"]


def test_lattice_writes_primitives_and_table(slipwise: Slipwise, arguments: list[object]) -> None:
    result = slipwise(*arguments)
    assert (result.code, result.err) == (0, "")
    content = json.loads(Path("out/lattice/lattice.json").read_text(encoding="utf-8"))
    assert content["lattice_metadata"]["num_of_headings"] == 16
    assert len(content["primitives"]) == content["lattice_metadata"]["number_of_trajectories"]
    assert f"{len(content['primitives'])} primitives over 16 headings at 0.5 m/s" in result.out


def test_a_side_that_was_never_driven_is_noted_once(slipwise: Slipwise, arguments: list[object]) -> None:
    make_model(replace(SKIDDING, yaw_rate=(0.0, 1.0))).save("model.yaml")
    result = slipwise(*arguments)
    assert result.code == 0
    assert result.err.startswith("note: a yaw rate of -")
    assert "is far beyond the 0 rad/s that the model has seen" in result.err
    assert result.err.count("note:") == 1


def test_the_table_has_what_slip_leaves(slipwise: Slipwise, arguments: list[object]) -> None:
    result = slipwise(*arguments, "--json", "-")
    assert result.code == 0
    table = np.genfromtxt("out/lattice/curvature.csv", delimiter=",", names=True)
    assert table["held_curvature"] == pytest.approx(0.7 * table["commanded_curvature"], abs=1e-5)
    tightest = table["held_curvature"].max()
    assert result.json["lattice_metadata"]["turning_radius"] == pytest.approx(1.0 / tightest, rel=0.1)


def test_a_bad_verdict_is_refused_unless_forced(slipwise: Slipwise, arguments: list[object]) -> None:
    make_model(replace(SKIDDING, good=False, sentence="It does not beat doing nothing.")).save("model.yaml")
    result = slipwise(*arguments)
    assert result.code == 1
    assert "NOT GOOD ENOUGH. It does not beat doing nothing." in result.out
    assert not Path("out").exists()
    assert slipwise(*arguments, "--force").code == 0


def test_a_model_of_wheels_alone_says_nothing_of_what_is_commanded(
    slipwise: Slipwise, arguments: list[object]
) -> None:
    make_model(replace(SKIDDING, commands=False)).save("model.yaml")
    result = slipwise(*arguments)
    assert result.code == 2
    assert "commands" in result.line
    assert not Path("out").exists()


def test_a_lattice_that_cannot_be_is_refused(
    slipwise: Slipwise, arguments: list[object], subtests: pytest.Subtests
) -> None:
    for given, message in [
        (("--headings", "12"), "12 headings"),
        (("--speed", "99"), "lattice options"),
        (("--grid", "0"), "grid is 0"),
        (("--curvature", "-1"), "the limit curvature is -1"),
        (("--longest", "0.5"), "some headings have no primitive"),
    ]:
        with subtests.test(given=given, message=message):
            result = slipwise(*arguments, *given)
            assert result.code == 2
            assert message in result.line
            assert not Path("out/lattice/lattice.json").exists()
