# SPDX-License-Identifier: Apache-2.0
"""Small pieces of HTML; whatever text comes from a user passes `escape`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape as _escape

from slipwise.number_text import number_text
from slipwise.reporting.dark_colours import css_colour

MINUS = "−"


def escape(text: object) -> str:
    """Return text that a browser shows as it is; control characters become a replacement character."""
    plain = "".join(c if c >= " " or c in "\n\t" else "\N{REPLACEMENT CHARACTER}" for c in str(text))
    return _escape(plain.encode("utf-8", "replace").decode("utf-8"), quote=True)


def number(value: float, digits: int = 3) -> str:
    """Return `number_text` with a true minus sign."""
    return number_text(value, digits).replace("-", MINUS)


def paragraph(text: str, *, kind: str = "") -> str:
    """Return a paragraph of plain text."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<p{attribute}>{escape(text)}</p>"


def missing(sentence: str) -> str:
    """Return the sentence that stands in place of a figure that cannot be drawn."""
    return paragraph(sentence, kind="missing")


def bullets(texts: Iterable[str]) -> str:
    """Return a list of plain texts."""
    return "<ul>" + "".join(f"<li>{escape(text)}</li>" for text in texts) + "</ul>"


def details(summary: str, html: str) -> str:
    """Return HTML that is folded away below a plain summary."""
    return f"<details><summary>{escape(summary)}</summary>{html}</details>"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, kind: str = "") -> str:
    """Return a table of plain texts that scrolls inside its own box."""
    cells = "".join(f'<th scope="col">{escape(text)}</th>' for text in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return scrolling(f'<table class="{kind}"><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>')


def scrolling(html: str) -> str:
    """Return wide HTML in a box that scrolls sideways, so that the page does not."""
    return f'<div class="scroll" tabindex="0">{html}</div>'


def grid(html: Iterable[str], *, kind: str = "grid") -> str:
    """Return pieces of HTML side by side; kinds are grid, fine-grid and wide-grid."""
    return f'<div class="{kind}">{"".join(html)}</div>'


def legend(entries: Iterable[tuple[str, str, str]]) -> str:
    """Return a line of (label, colour, kind of mark), kinds being line, dash, dot, mark, ring and area."""
    items = (
        f'<li><span class="key {kind}" style="color:{css_colour(colour)}"></span>{escape(label)}</li>'
        for label, colour, kind in entries
    )
    return f'<ul class="legend">{"".join(items)}</ul>'
