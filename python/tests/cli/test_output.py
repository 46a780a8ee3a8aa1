# SPDX-License-Identifier: Apache-2.0
"""Tables are for people and whole in a pipe; JSON is for machines and valid."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from slipwise.cli.output import Column, Output, to_json
from slipwise.cli.tables import in_plain_units
from slipwise.models.schema import Parameter


def test_numbers_that_are_not_finite_become_null() -> None:
    content = {"a": float("nan"), "b": (1.0, float("inf")), "path": Path("x"), 2.0: True}
    assert json.loads(to_json(content)) == {"a": None, "b": [1.0, None], "path": "x", "2.0": True}


def test_a_wide_table_is_not_cut_in_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    cells = ["x" * 30, "[1, 2]", "y" * 60]
    Output(None).table("Title", [Column(c) for c in "abc"], [cells])
    out = capsys.readouterr().out
    assert all(cell in out for cell in cells)


def test_nothing_but_json_is_printed_where_json_goes_to_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    output = Output(Path("-"))
    output.line("text")
    output.table("Title", [Column("a")], [["1"]])
    output.document({"a": 1})
    assert json.loads(capsys.readouterr().out) == {"a": 1}


def test_what_is_learned_as_a_logarithm_is_shown_in_seconds() -> None:
    learned = Parameter(name="log_lag_v", unit="ln s", value=0.0, std=0.1, prior_std=0.8, determined=True)
    assert in_plain_units(learned) == ("lag_v", 1.0, 0.1, "s")
