# SPDX-License-Identifier: Apache-2.0
"""The exhibits as Markdown, with the pictures beside it."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise.thesis.exhibit import Exhibit
from slipwise.thesis.grid import Grid
from slipwise.thesis.introduction import INTRODUCTION, TITLE
from slipwise.thesis.reproduce import ChapterResult


def markdown(chapters: Sequence[ChapterResult]) -> str:
    """Return the page; pictures are named by the exhibits' keys."""
    lines = [f"# {TITLE}", "", INTRODUCTION, ""]
    for chapter in chapters:
        lines += [f"- **{_plain(chapter.title)}**"]
        lines += [f"  - [{_heading(exhibit)}](#{_anchor(_heading(exhibit))})" for exhibit in chapter.exhibits]
    for chapter in chapters:
        lines += ["", f"## {_plain(chapter.title)}"]
        for exhibit in chapter.exhibits:
            lines += ["", *_exhibit(exhibit)]
    return "\n".join(lines) + "\n"


def _exhibit(exhibit: Exhibit) -> list[str]:
    lines = [f"### {_heading(exhibit)}", ""]
    if exhibit.missing:
        return [*lines, f"Not made: {_plain(exhibit.missing)}"]
    lines += [_plain(exhibit.shows), ""]
    if exhibit.panels:
        lines += [f"![{_heading(exhibit)}]({exhibit.key}.png)", ""]
    for grid in exhibit.grids:
        lines += [*_grid(grid), ""]
    lines += [
        f"**Agrees.** {_plain(exhibit.agrees)}",
        "",
        f"**Differs.** {_plain(exhibit.differs)}",
        "",
        f"*Data: {_plain(exhibit.source)}*",
    ]
    return lines


def _grid(grid: Grid) -> list[str]:
    head = [f"*{_plain(grid.title)}*", ""] if grid.title else []
    rows = [grid.columns, ("---",) * len(grid.columns), *grid.rows]
    table = [
        "| " + " | ".join(_plain(cell) if row is not rows[1] else cell for cell in row) + " |" for row in rows
    ]
    return head + table + (["", _plain(grid.note)] if grid.note else [])


def _heading(exhibit: Exhibit) -> str:
    return f"{_plain(exhibit.thesis)}: {_plain(exhibit.title)}"


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
