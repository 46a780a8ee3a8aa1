# SPDX-License-Identifier: Apache-2.0
"""`slipwise show` says what a model file says, in words first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from cli.conftest import Result
from sample_models import make_model, named

from slipwise.models.summary import summarise

Slipwise = Callable[..., Result]


@pytest.fixture
def model(folder: Path) -> Path:
    return make_model(replace(named("edd-2", ang__w=-0.4), commands=True)).save(folder / "model.yaml")


def test_words_come_before_the_verdict_and_numbers_last(slipwise: Slipwise, model: Path) -> None:
    result = slipwise("show", model)
    assert (result.code, result.err) == (0, "")
    said = ("turns 60.0", "GOOD. ", "drives/monday.mcap", "Holds from -0.500 to 1.50 m/s", "delay_v")
    places = [result.out.index(text) for text in said]
    assert places == sorted(places)
    assert "log_" not in result.out


def test_json_has_the_same_sentences_and_physical_units(slipwise: Slipwise, model: Path) -> None:
    from slipwise import load_model

    document = slipwise("show", model, "--json", "-").json
    assert document["summary"] == list(summarise(load_model(model)).sentences)
    delay = next(p for p in document["parameters"] if p["name"] == "delay_v")
    assert delay["unit"] == "s"
    assert delay["value"] == pytest.approx(0.2)
    assert delay["identified"] is True


def test_a_bad_model_is_shown_and_called_that(slipwise: Slipwise, folder: Path) -> None:
    bad = make_model(replace(named("edd-2"), good=False, sentence="It misses.")).save(folder / "bad.yaml")
    result = slipwise("show", bad)
    assert result.code == 0
    assert "NOT GOOD ENOUGH. It misses." in result.out


def test_control_characters_of_a_model_file_do_not_reach_the_terminal(
    slipwise: Slipwise, folder: Path
) -> None:
    made = replace(named("edd-2"), log="\x1b[31mred\nline", sentence="A\x1b]0;title\x07B")
    assert "\x1b" not in slipwise("show", make_model(made).save(folder / "m.yaml")).out


def test_surfaces_that_are_remembered_have_a_table(slipwise: Slipwise, folder: Path) -> None:
    from slipwise.models import Model
    from slipwise.models.schema import SurfaceSection

    made = make_model(replace(named("edd-2", ang__w=-0.4), commands=True))
    sand = SurfaceSection(
        name="sand",
        seconds=60.0,
        segments=24,
        visits=2,
        speed=1.0,
        yaw_rate=0.5,
        slip=[-0.1, -0.5],
        covariance=[[1e-4, 0.0], [0.0, 1e-4]],
    )
    path = Model(made.content.model_copy(update={"surfaces": [sand]})).save(folder / "sand.yaml")
    assert "sand" in slipwise("show", path).out
    assert slipwise("show", path, "--json", "-").json["surfaces"][0]["visits"] == 2
    target = folder / "model.h"
    assert slipwise("export", path, "--to", "c-header", "-o", target, "--surface", "sand").code == 0
    assert slipwise("export", path, "--to", "c-header", "-o", target, "--surface", "ice").code != 0
