# SPDX-License-Identifier: Apache-2.0
"""The figures and tables as one HTML page that works offline; surfaces can be turned."""

from __future__ import annotations

from collections.abc import Sequence

from slipwise.reporting.markup import escape, legend, missing, paragraph, table
from slipwise.reporting.page import document
from slipwise_thesis.chapters import ChapterResult
from slipwise_thesis.grid import Grid
from slipwise_thesis.introduction import INTRODUCTION, TITLE
from slipwise_thesis.panel import ErrorBars, Heat, Line, Panel, Points, Surface
from slipwise_thesis.plotly_panel import plotly_panel
from slipwise_thesis.thesis_figure import ThesisFigure


def draw_page(chapters: Sequence[ChapterResult]) -> str:
    """Return the whole page; the same figures give the same bytes."""
    links = "".join(f'<a href="#{chapter.key}">{escape(chapter.title)}</a>' for chapter in chapters)
    contents = "".join(_contents(chapter) for chapter in chapters)
    body = "\n".join(_chapter(chapter) for chapter in chapters)
    first = f"<section>{paragraph(INTRODUCTION, kind='explanation')}{contents}</section>"
    whole = f"<nav>{links}</nav>\n<main>\n{first}\n{body}\n</main>"
    return document(TITLE, "slipwise reproduce thesis", whole, solids=True)


def _contents(chapter: ChapterResult) -> str:
    items = "".join(
        f'<li><a href="#{figure.key}">{escape(figure.thesis)}: {escape(figure.title)}</a></li>'
        for figure in chapter.figures
    )
    return f"<h3>{escape(chapter.title)}</h3><ul>{items}</ul>"


def _chapter(chapter: ChapterResult) -> str:
    figures = "\n".join(_figure(figure) for figure in chapter.figures)
    return f'<h2 id="{chapter.key}">{escape(chapter.title)}</h2>\n{figures}'


def _figure(figure: ThesisFigure) -> str:
    head = f'<section id="{figure.key}"><h2>{escape(figure.thesis)}: {escape(figure.title)}</h2>'
    if figure.missing:
        return f"{head}{missing(f'Not made: {figure.missing}')}</section>"
    drawn = "".join(
        f"<div>{plotly_panel(f'{figure.key}-{place}', panel).html()}{_legend(panel)}</div>"
        for place, panel in enumerate(figure.panels, start=1)
    )
    texts = (("Agrees", figure.agrees), ("Differs, and why", figure.differs), ("Data", figure.source))
    sentences = "".join(f"<p><strong>{name}.</strong> {escape(text)}</p>" for name, text in texts)
    grids = "".join(_grid(grid) for grid in figure.grids)
    kind = "wide-grid" if len(figure.panels) in (1, 2, 4) else "grid"
    return (
        f"{head}{paragraph(figure.shows, kind='explanation')}"
        f'<div class="{kind}">{drawn}</div>{grids}{sentences}</section>'
    )


def _grid(grid: Grid) -> str:
    heading = f"<h3>{escape(grid.title)}</h3>" if grid.title else ""
    note = paragraph(grid.note, kind="explanation") if grid.note else ""
    return heading + table(grid.columns, grid.rows) + note


def _legend(panel: Panel) -> str:
    entries: dict[str, tuple[str, str, str]] = {}
    for series, colour in panel.coloured():
        if isinstance(series, Heat | Surface) or not series.label:
            continue
        kind = "area"
        if isinstance(series, Line):
            kind = {"solid": "line", "dot": "dot"}.get(series.dash, "dash")
        elif isinstance(series, Points | ErrorBars):
            kind = "ring" if series.mark == "ring" else "mark"
        entries.setdefault(series.label, (series.label, colour, kind))
    return legend(entries.values()) if entries else ""
