# SPDX-License-Identifier: Apache-2.0
"""What the node says becomes levels, sentences and values that diagnostics viewers show."""

from __future__ import annotations

import math
from typing import Any

import pytest
from live.sample_outputs import driven_status, surface_at, waiting_status

from slipwise.live.diagnostics import Level, diagnostics_of, note_diagnostic
from slipwise.live.outputs import Note, ParameterNow


def _levels(**changes: Any) -> list[Level]:
    return [one.level for one in diagnostics_of(waiting_status(**changes), "slipwise")]


@pytest.mark.parametrize(
    ("state", "level"),
    [("waiting", Level.STALE), ("learning", Level.OK), ("not learning", Level.OK), ("stuck", Level.ERROR)],
)
def test_level_of_the_state(state: str, level: Level) -> None:
    assert _levels(state=state)[0] is level


@pytest.mark.parametrize(
    ("validity", "level"),
    [("estimated", Level.OK), ("unestimated", Level.WARN), ("invalid", Level.ERROR)],
)
def test_level_of_the_model_is_that_of_its_validity(validity: str, level: Level) -> None:
    assert _levels(validity=validity)[1] is level


def test_a_drive_has_keys_for_every_parameter_and_says_why() -> None:
    status = driven_status()
    state, model, parameters = diagnostics_of(status, "slipwise")
    assert [one.name for one in (state, model, parameters)] == [
        "slipwise: state",
        "slipwise: model",
        "slipwise: parameters",
    ]
    assert model.message == f"estimated: {status.validity_why}"
    values = dict(parameters.values)
    for parameter in status.parameters:
        assert float(values[parameter.name]) == pytest.approx(parameter.value, rel=1e-5)
        assert float(values[f"{parameter.name} std"]) == pytest.approx(parameter.std, rel=1e-5)
        applied = "nothing" if parameter.applied is None else f"{parameter.applied:.6g}"
        assert values[f"{parameter.name} applied"] == applied
    assert dict(state.values)["rejected: standstill"] == str(status.counts["standstill"])
    assert dict(model.values)["segments"] == str(status.segments)


def test_the_worst_parameter_gives_the_level_of_all() -> None:
    good = ParameterNow("a", "s", 1.0, 0.1, 0.3, "estimated", 1.0)
    bad = ParameterNow("b", "s", math.nan, math.inf, 0.3, "invalid", 1.0)
    assert _levels(parameters=(good,))[2] is Level.OK
    assert _levels(parameters=(good, bad))[2] is Level.ERROR
    values = dict(diagnostics_of(waiting_status(parameters=(bad,)), "slipwise")[2].values)
    assert (values["b"], values["b std"]) == ("nan", "inf")


def test_it_is_said_which_model_others_have() -> None:
    said = "the last valid one; the model is invalid now"
    model = diagnostics_of(waiting_status(validity="invalid", given=said), "slipwise")[1]
    assert dict(model.values)["others have"] == said


def test_a_note_is_a_line_of_its_own() -> None:
    one = note_diagnostic(Note(1.0, "nothing comes on /odom"), "husky")
    assert (one.level, one.name, one.message) == (Level.OK, "husky: note", "nothing comes on /odom")


def test_the_surface_has_a_line_of_its_own_where_surfaces_are_remembered() -> None:
    *_, line = diagnostics_of(waiting_status(surface=surface_at()), "slipwise")
    assert (line.name, line.level, line.message) == ("slipwise: surface", Level.OK, "sand (0.90)")
    values = dict(line.values)
    assert values["probability of sand"] == "0.9"
    assert float(values["probability of a new surface"]) == pytest.approx(0.1)
    assert values["remembered: hall"] == "10.0 min, 2 visits, 2026-01-02"
    assert values["labels right"] == "2 of 3"
