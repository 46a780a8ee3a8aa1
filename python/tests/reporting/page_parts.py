# SPDX-License-Identifier: Apache-2.0
"""Taking a page, or one section, apart to look at its pieces."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

from reporting.synthetic_results import Results

from slipwise.reporting import SECTIONS, Contents, Section
from slipwise.reporting.page import page


def contents_of(results: Results, *, title: str = "A drive", command: str = "") -> Contents:
    """Return what the sections are given."""
    return Contents(results.log, results.calibration, results.evaluation, title, command)


def html_of(
    results: Results, *, title: str = "A drive", command: str = "", sections: Sequence[Section] = SECTIONS
) -> str:
    """Return the whole page."""
    return page(contents_of(results, title=title, command=command), sections)


def figures_of(html: str) -> dict[str, dict[str, Any]]:
    """Return the data of every figure by its id."""
    found = re.findall(
        r'<script type="application/json" data-figure="([^"]+)">(.*?)</script>', html, re.DOTALL
    )
    return {name: json.loads(text) for name, text in found}


def headings_of(html: str) -> list[str]:
    """Return the titles of the sections."""
    return re.findall(r"<h2>(.*?)</h2>", html)


def text_of(html: str) -> str:
    """Return what a reader sees of a section, without its figures."""
    without_data = re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", without_data).split())
