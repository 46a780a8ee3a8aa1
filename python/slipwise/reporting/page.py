# SPDX-License-Identifier: Apache-2.0
"""The HTML page around the sections: all inlined, with a policy that forbids every request."""

from __future__ import annotations

import base64
import gzip
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources

from slipwise.reporting.contents import Contents, Section
from slipwise.reporting.dark_colours import dark_style
from slipwise.reporting.markup import escape


@dataclass(frozen=True)
class Part:
    """One heading of a page with what stands below it."""

    title: str
    explanation: str
    html: str
    folded: bool = False  # shown when its heading is clicked


def page(contents: Contents, sections: Sequence[Section]) -> str:
    """Return the report's whole page: the first section, and the others folded under their headings."""
    parts = [
        Part(section.title, section.explanation, section.html(contents), folded=place > 0)
        for place, section in enumerate(sections)
    ]
    return page_of(contents.title, "slipwise motion model report", parts)


def page_of(title: str, kicker: str, parts: Sequence[Part]) -> str:
    """Return a whole page of parts; see `document`."""
    bodies = [_section(f"section-{place}", part) for place, part in enumerate(parts, start=1)]
    unfolding = '<p class="unfolding"><button type="button" data-unfold>unfold all</button></p>'
    first_folded = next((place for place, part in enumerate(parts) if part.folded), None)
    if first_folded is not None:
        bodies.insert(first_folded, unfolding)
    return document(title, kicker, "<main>\n" + "\n".join(bodies) + "\n</main>")


def document(title: str, kicker: str, body: str, *, solids: bool = False) -> str:
    """Return a whole document around HTML with figures; only its own scripts may run, nothing may be fetched.

    Args:
        title: heading of the page, any text.
        kicker: a few words above the heading.
        body: HTML that follows the heading.
        solids: whether figures have three dimensions; the page is 3 MB larger then.
    """
    plotly, script = drawing_script(solids=solids), _asset("report.js")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_policy(plotly, script)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        '<link rel="icon" href="data:,">\n'
        f"<title>{escape(title)}</title>\n<style>{_asset('report.css')}{dark_style()}</style>\n</head>\n<body>\n"
        f"<header><p>{escape(kicker)}</p><h1>{escape(title)}</h1></header>\n"
        f"{body}\n"
        f"<script>{plotly}</script>\n<script>{script}</script>\n</body>\n</html>\n"
    )


def drawing_script(*, solids: bool = False) -> str:
    """Return plotly.js (MIT), without `solids` less its maps and three dimensions: a third of the size."""
    if solids:
        from plotly.offline import get_plotlyjs

        return str(get_plotlyjs())
    packed = resources.files("slipwise.reporting").joinpath("plotly-cartesian.min.js.gz").read_bytes()
    return gzip.decompress(packed).decode()


def _section(name: str, part: Part) -> str:
    head = f"<h2>{escape(part.title)}</h2>"
    if part.folded:
        explanation = f'<span class="explanation">{escape(part.explanation)}</span>'
        summary = f"<summary>{head} {explanation}</summary>"
        return f'<details class="section" id="{name}">{summary}{part.html}</details>'
    explanation = f'<p class="explanation">{escape(part.explanation)}</p>'
    return f'<section id="{name}">{head}{explanation}{part.html}</section>'


def _policy(*scripts: str) -> str:
    """Return the content security policy: these scripts by hash, inline style, images made here, no more."""
    hashes = " ".join(
        f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for s in scripts
    )
    return (
        f"default-src 'none'; script-src {hashes}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )


def _asset(name: str) -> str:
    return resources.files("slipwise.reporting").joinpath(name).read_text(encoding="utf-8")
