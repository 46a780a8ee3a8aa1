# SPDX-License-Identifier: Apache-2.0
"""The figures and tables as Markdown, with the pictures beside it."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise_thesis.chapters import ChapterResult
from slipwise_thesis.grid import Grid
from slipwise_thesis.introduction import INTRODUCTION, TITLE
from slipwise_thesis.thesis_figure import ThesisFigure


def markdown(chapters: Sequence[ChapterResult]) -> str:
    """Return the page; pictures are named by the figures' keys."""
    lines = [f"# {TITLE}", "", INTRODUCTION, ""]
    for chapter in chapters:
        lines += [f"- **{_plain(chapter.title)}**"]
        lines += [f"  - [{_heading(figure)}](#{_anchor(_heading(figure))})" for figure in chapter.figures]
    for chapter in chapters:
        lines += ["", f"## {_plain(chapter.title)}"]
        for figure in chapter.figures:
            lines += ["", *_figure(figure)]
    return "\n".join(lines) + "\n"


def _figure(figure: ThesisFigure) -> list[str]:
    lines = [f"### {_heading(figure)}", ""]
    if figure.missing:
        return [*lines, f"Not made: {_plain(figure.missing)}"]
    lines += [_plain(figure.shows), ""]
    if figure.panels:
        lines += [f"![{_heading(figure)}]({figure.key}.png)", ""]
    for grid in figure.grids:
        lines += [*_grid(grid), ""]
    lines += [
        f"**Agrees.** {_plain(figure.agrees)}",
        "",
        f"**Differs.** {_plain(figure.differs)}",
        "",
        f"*Data: {_plain(figure.source)}*",
    ]
    return lines


def _grid(grid: Grid) -> list[str]:
    head = [f"*{_plain(grid.title)}*", ""] if grid.title else []
    rows = [grid.columns, ("---",) * len(grid.columns), *grid.rows]
    table = [
        "| " + " | ".join(_plain(cell) if row is not rows[1] else cell for cell in row) + " |" for row in rows
    ]
    return head + table + (["", _plain(grid.note)] if grid.note else [])


def _heading(figure: ThesisFigure) -> str:
    return f"{_plain(figure.thesis)}: {_plain(figure.title)}"


def _anchor(heading: str) -> str:
    """Return the anchor that code hosts make of a heading."""
    kept = [c for c in heading.lower() if c in " -_" or c.isalnum()]
    return "".join(kept).replace(" ", "-")


def _plain(text: str) -> str:
    """Return text on one line in which Markdown marks nothing."""
    marked = " ".join(text.split())
    for mark in "\\`*_<|":
        marked = marked.replace(mark, f"\\{mark}")
    return marked
