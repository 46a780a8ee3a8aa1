# SPDX-License-Identifier: Apache-2.0
"""`slipwise excite` writes a table, a bag and a page, or says what is wrong."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_models import make_model, named

from slipwise import _core
from slipwise.cli.excite import _known
from slipwise.excitation import CommandSpace, prior_knowledge
from slipwise.models import Model, load_model

Slipwise = Callable[..., Result]
QUICK = ("--area", "20x20", "--minutes", "0.4")


@pytest.mark.slow
def test_excite_writes_table_bag_page_and_document(slipwise: Slipwise, folder: Path) -> None:
    result = slipwise("excite", *QUICK, "--vehicle", "husky", "-o", "first", "--json", "first.json")
    assert (result.code, result.err) == (0, "")
    assert "moves of 2.00 s" in result.out
    assert Path("first.csv").read_text(encoding="utf-8").startswith("t,cmd_v,cmd_omega\n")
    assert Path("first.mcap").read_bytes().startswith(b"\x89MCAP")
    assert "What each move teaches" in Path("first.html").read_text(encoding="utf-8")
    document = json.loads(Path("first.json").read_text(encoding="utf-8"))
    assert document["lessons"][-1]["worst_yaw_std"] < document["lessons"][0]["worst_yaw_std"]
    assert len(document["parameters"]) == len(document["lessons"][0]["std"])


@pytest.mark.slow
def test_model_says_what_is_known_and_the_limits(slipwise: Slipwise, folder: Path) -> None:
    make_model(replace(named("edd-2", ang__w=-0.3), commands=True)).save(folder / "model.yaml")
    result = slipwise("excite", *QUICK, "--model", "model.yaml", "-o", "second", "--json", "-")
    assert (result.code, result.err) == (0, "")
    document = json.loads(result.out)
    assert document["parameters"][0] == "lon.V"


@pytest.mark.slow
def test_a_drive_in_reverse_that_the_model_never_saw_is_said(slipwise: Slipwise, folder: Path) -> None:
    forward = replace(named("edd-2", ang__w=-0.3), commands=True, speed=(0.0, 1.0))
    make_model(forward).save(folder / "model.yaml")
    result = slipwise("excite", *QUICK, "--model", "model.yaml")
    assert result.code == 0
    assert re.search("It drives in reverse, down to -[0-9.]+ m/s, which the model has never seen", result.out)


def test_wrong_use_ends_with_code_2_and_says_why(
    slipwise: Slipwise, folder: Path, subtests: pytest.Subtests
) -> None:
    make_model(named("edd-2", ang__w=-0.3)).save(folder / "wheel.yaml")
    for arguments, message in [
        (("--model", "wheel.yaml"), "nothing from commands"),
        (("--vehicle", "unicycle"), "husky"),
        (("--vehicle", "husky", "--topic", "bad topic"), "not the name of a topic"),
        ((), "--vehicle"),
        (("--vehicle", "husky", "--area", "8"), "8x8"),
        (("--vehicle", "husky", "--minutes", "0.01"), "too short"),
        (("--vehicle", "husky", "--speed", "-1"), "speed"),
        (("--vehicle", "husky", "--hold", "0.33"), "hold"),
        (("--vehicle", "husky", "--model", "a.yaml", "--prior", "b.yaml"), "--prior"),
        (("--vehicle", "husky", "--prior", "b.yaml"), "b.yaml"),
    ]:
        with subtests.test(arguments=arguments, message=message):
            result = slipwise("excite", *arguments)
            assert result.code == 2
            assert message in result.err
            assert not list(folder.glob("excite.*"))


def test_a_bad_verdict_is_refused(slipwise: Slipwise, folder: Path) -> None:
    bad = replace(named("edd-2"), commands=True, good=False, sentence="It does not beat doing nothing.")
    make_model(bad).save(folder / "model.yaml")
    result = slipwise("excite", "--model", "model.yaml")
    assert result.code == 1
    assert "NOT GOOD ENOUGH. It does not beat doing nothing." in result.out
    assert not list(folder.glob("excite.*"))


def test_of_a_model_that_learned_nothing_the_prior_is_what_is_known(folder: Path) -> None:
    model = make_model(replace(named("edd-2"), basis=_core.Basis("none", [], [], []), values={}))
    assert not model.content.parameters
    Model(model.content.model_copy(update={"input": "command"})).save(folder / "nothing.yaml")
    given = {"speed": 1.0, "yaw_rate": 1.0}
    _, known = _known((load_model(folder / "nothing.yaml"), None), None, given)
    assert known.names == prior_knowledge(CommandSpace(1.0, 1.0)).names
