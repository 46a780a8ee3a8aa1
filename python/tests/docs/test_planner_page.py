# SPDX-License-Identifier: Apache-2.0
"""The page about planners shows the program that is built, with the header that slipwise exports now."""

from __future__ import annotations

from python.tests.docs.pages import ROOT, blocks

from slipwise.export import export_model
from slipwise.models import load_model

PAGE = ROOT / "docs/use-it-in-your-planner.md"
EXAMPLE = ROOT / "examples/planner"


def test_the_page_shows_the_files_of_the_example() -> None:
    assert blocks(PAGE, "cmake") == [(EXAMPLE / "CMakeLists.txt").read_text(encoding="utf-8")]
    assert blocks(PAGE, "cpp") == [(EXAMPLE / "planner.cpp").read_text(encoding="utf-8")]


def test_the_header_of_the_example_is_up_to_date() -> None:
    made = export_model(load_model(EXAMPLE / "model.yaml"), "c-header", name="model.yaml").text
    kept = (EXAMPLE / "model.h").read_text(encoding="utf-8")
    advice = "run `slipwise export model.yaml --to c-header -o model.h` in examples/planner"
    assert kept.split("*/", 1)[1] == made.split("*/", 1)[1], advice
