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
    """Return the whole page; only Plotly and the page's own script may run, nothing may be fetched."""
    plotly, script = get_plotlyjs(), _asset("report.js")
    bodies = [
        _section(f"section-{place}", section, contents) for place, section in enumerate(sections, start=1)
    ]
    links = "".join(
        f'<a href="#section-{place}">{escape(section.title)}</a>'
        for place, section in enumerate(sections, start=1)
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{_policy(plotly, script)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<link rel="icon" href="data:,">\n'
        f"<title>{escape(contents.title)}</title>\n<style>{_asset('report.css')}</style>\n</head>\n<body>\n"
        f"<header><p>slipwise motion model report</p><h1>{escape(contents.title)}</h1></header>\n"
        f"<nav>{links}</nav>\n<main>\n" + "\n".join(bodies) + "\n</main>\n"
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
