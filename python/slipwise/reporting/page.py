# SPDX-License-Identifier: Apache-2.0
"""The HTML page around the sections: all inlined, with a policy that forbids every request."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from importlib import resources

from plotly.offline import get_plotlyjs

from slipwise.reporting.contents import Contents
from slipwise.reporting.markup import escape
from slipwise.reporting.section import Section


def page(contents: Contents, sections: Sequence[Section]) -> str:
    """Return the report's page; only Plotly and the page's own script may run, nothing may be fetched."""
    bodies = [
        _section(f"section-{place}", section, contents) for place, section in enumerate(sections, start=1)
    ]
    links = "".join(
        f'<a href="#section-{place}">{escape(section.title)}</a>'
        for place, section in enumerate(sections, start=1)
    )
    body = f"<nav>{links}</nav>\n<main>\n" + "\n".join(bodies) + "\n</main>"
    return document(contents.title, "slipwise motion model report", body)


def document(title: str, kicker: str, body: str) -> str:
    """Return a whole document around HTML with figures.

    Args:
        title: heading of the page, any text.
        kicker: a few words above the heading.
        body: HTML that follows the heading.
    """
    plotly, script = get_plotlyjs(), _asset("report.js")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_policy(plotly, script)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<link rel="icon" href="data:,">\n'
        f"<title>{escape(title)}</title>\n<style>{_asset('report.css')}</style>\n</head>\n<body>\n"
        f"<header><p>{escape(kicker)}</p><h1>{escape(title)}</h1></header>\n"
        f"{body}\n"
        f"<script>{plotly}</script>\n<script>{script}</script>\n</body>\n</html>\n"
    )


def _section(name: str, section: Section, contents: Contents) -> str:
    return (
        f'<section id="{name}"><h2>{escape(section.title)}</h2>'
        f'<p class="explanation">{escape(section.explanation)}</p>{section.html(contents)}</section>'
    )


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
