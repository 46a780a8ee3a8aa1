# SPDX-License-Identifier: Apache-2.0
"""Tables are for people and whole in a pipe; JSON is for machines and valid."""

from __future__ import annotations

import io
import json
import re
import sys
from pathlib import Path

import pytest

from slipwise.cli.output import Column, Output, to_json, wrapped_text
from slipwise.cli.tables import show_parameters
from slipwise.models.parameter_table import PhysicalParameter


def test_numbers_that_are_not_finite_become_null() -> None:
    content = {"a": float("nan"), "b": (1.0, float("inf")), "path": Path("x"), 2.0: True}
    assert json.loads(to_json(content)) == {"a": None, "b": [1.0, None], "path": "x", "2.0": True}


def test_a_wide_table_is_not_cut_in_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    cells = ["x" * 30, "[1, 2]", "y" * 60]
    Output(None).table("Title", [Column(c) for c in "abc"], [cells])
    out = capsys.readouterr().out
    assert all(cell in out for cell in cells)


def test_a_table_goes_without_its_spare_columns_where_it_is_too_wide_and_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "0")  # no terminal is wider
    monkeypatch.setattr("slipwise.cli.output.WIDTH_OF_A_PIPE", 60)
    columns = [Column("name", whole=True), Column("kept", whole=True)]
    columns += [Column("first", whole=True, spare=2), Column("second", whole=True, spare=1)]
    Output(None).table("Title", columns, [["x" * 20, "1" * 12, "2" * 12, "3" * 12]])
    out = " ".join(capsys.readouterr().out.split())
    assert ("x" * 20 + " " + "1" * 12 + " " + "3" * 12) in out
    assert "2" * 12 not in out
    assert "Too narrow for first: a wider terminal or --json has them." in out
    Output(None).table("Title", columns, [["x" * 10, "1", "2", "3"]])
    assert "Too narrow" not in capsys.readouterr().out


def test_numbers_stay_whole_where_names_are_broken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "0")  # no terminal is wider
    monkeypatch.setattr("slipwise.cli.output.WIDTH_OF_A_PIPE", 40)
    columns = [Column("name"), Column("a_long_head_of_a_file.yaml", True), Column("b", True)]
    Output(None).table("Title", columns, [["n" * 40, "0.0176 ± 0.0010", "-8.2"]])
    out = capsys.readouterr().out
    assert "0.0176 ± 0.0010" in out
    assert "-8.2" in out
    assert max(map(len, out.splitlines())) <= 40


def test_nothing_but_json_is_printed_where_json_goes_to_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    output = Output(Path("-"))
    output.line("text")
    output.table("Title", [Column("a")], [["1"]])
    output.document({"a": 1})
    assert json.loads(capsys.readouterr().out) == {"a": 1}


def test_a_line_in_a_pipe_is_one_line_without_a_colour(capsys: pytest.CaptureFixture[str]) -> None:
    Output(None).line("word " * 40, label="GOOD.", colour="green")
    assert capsys.readouterr().out == "GOOD. " + "word " * 40 + "\n"


def test_a_line_is_broken_between_words_and_keeps_its_indentation() -> None:
    broken = wrapped_text("  " + "word " * 10 + "/a/path/that-is-longer-than/twenty/characters", 22)
    assert broken.splitlines()[:2] == ["  word word word word", "  word word word word"]
    assert broken.splitlines()[-1] == "  /a/path/that-is-longer-than/twenty/characters"


def test_a_terminal_gets_colour_and_eighty_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = io.StringIO()
    monkeypatch.setattr(shown, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stdout", shown)
    for name, value in (("TERM", "xterm"), ("COLUMNS", "80")):
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("NO_COLOR", raising=False)
    output = Output(None)
    output.line("word " * 40, label="NOT GOOD ENOUGH.", colour="red")
    show_parameters(output, [PhysicalParameter("lon.w^2*sgn(V)", -0.1, 0.02, "m/s per w^2*sgn(V)", True)])
    text = shown.getvalue()
    assert text.startswith("\x1b[1;31mNOT GOOD ENOUGH.\x1b[0m word")
    plain = re.sub(r"\x1b\[[0-9;]*m", "", text)
    assert max(map(len, plain.splitlines())) <= 80
    assert re.search(r"lon\.w\^2\*sgn\(V\) +-0\.10 +0\.02 +m/s per w\^2\*sgn\(V\) +yes", plain)
