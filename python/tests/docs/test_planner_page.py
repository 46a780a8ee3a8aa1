# SPDX-License-Identifier: Apache-2.0
"""The page about planners shows lines of the program that is built."""

from __future__ import annotations

from python.tests.docs.pages import ROOT, blocks

PAGE = ROOT / "docs/use-it-in-your-planner.md"
EXAMPLE = ROOT / "examples/planner"


def test_the_page_shows_the_files_of_the_example() -> None:
    assert blocks(PAGE, "cmake") == [(EXAMPLE / "CMakeLists.txt").read_text(encoding="utf-8")]
    (excerpt,) = blocks(PAGE, "cpp")
    assert "linearize_segment" in excerpt
    assert excerpt in (EXAMPLE / "planner.cpp").read_text(encoding="utf-8")
