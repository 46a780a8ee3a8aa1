# SPDX-License-Identifier: Apache-2.0
"""`slipwise reproduce` writes its documents, counts what is missing, and refuses what it cannot do."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result

Slipwise = Callable[..., Result]
pytest.importorskip("mujoco")
pytest.importorskip("matplotlib")
pytest.importorskip("sklearn")


def test_a_chapter_is_made_again_and_listed(slipwise: Slipwise, folder: Path) -> None:
    result = slipwise("reproduce", "thesis", "--only", "chapter-3", "-o", "out", "--json", "result.json")
    assert (result.code, result.err) == (0, "")
    assert "Equation 3.9" in result.out
    assert "2 figures and tables were made, 0 could not be." in result.out
    names = {str(path.relative_to("out")) for path in Path("out").rglob("*.*")}
    pictures = {"markdown/equation-3-8.png", "markdown/equation-3-9.png"}
    assert names == {"index.html", "markdown/README.md"} | pictures
    assert '"thesis": "Equation 3.9"' in Path("result.json").read_text(encoding="utf-8")
    assert not Path("runs").exists()


def test_an_unknown_chapter_is_refused_before_the_work(slipwise: Slipwise, folder: Path) -> None:
    result = slipwise("reproduce", "thesis", "--only", "chapter-1")
    assert result.code == 2
    assert "unknown chapter 'chapter-1' (--only): known are chapter-2, chapter-3, chapter-4" in result.line
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("library", ["slipwise_sim", "sklearn"])
def test_a_missing_library_is_named_with_the_extra(
    slipwise: Slipwise, folder: Path, monkeypatch: pytest.MonkeyPatch, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    result = slipwise("reproduce", "thesis", "--only", "chapter-3")
    assert result.code == 2
    assert f"the reproduction needs {library}" in result.line
    assert "make all" in result.line
    assert list(folder.iterdir()) == []


def test_without_matplotlib_the_page_is_written_and_what_is_left_out_is_said(
    slipwise: Slipwise, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    result = slipwise("reproduce", "thesis", "--only", "chapter-3", "-o", "out")
    assert result.code == 0
    assert [path.name for path in (folder / "out").iterdir()] == ["index.html"]
    assert "The Markdown with its pictures was left out: it needs Matplotlib" in result.out
