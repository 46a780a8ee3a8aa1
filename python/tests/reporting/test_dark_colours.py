# SPDX-License-Identifier: Apache-2.0
"""The dark twins of colours can be told from the dark page."""

from __future__ import annotations

import re

from reporting.page_parts import figures_of, html_of
from reporting.synthetic_results import METHODS, make_results

from slipwise.reporting.dark_colours import DARK, css_colour, dark_style
from slipwise.reporting.markup import legend
from slipwise.reporting.palette import MEASURED, stroke_of

PAPER = DARK["#ffffff"]


def _luminance(colour: str) -> float:
    parts = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    red, green, blue = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _contrast(one: str, other: str) -> float:
    high, low = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_lines_of_all_methods_and_the_measured_one_stand_out_on_dark_paper() -> None:
    colours = [MEASURED, *(stroke_of(name, METHODS).colour for name in METHODS)]
    assert all(_contrast(DARK.get(colour, colour), PAPER) > 4.5 for colour in colours)


def test_every_line_and_text_of_a_page_can_be_seen_on_dark_paper() -> None:
    figures = figures_of(html_of(make_results(runs=2)))
    shown = [trace.get("line", {}).get("color") for f in figures.values() for trace in f["data"]]
    shown += [figure["layout"]["font"]["color"] for figure in figures.values()]
    colours = {colour for colour in shown if isinstance(colour, str)}
    assert len(colours) > 4
    faint = {c for c in colours if _contrast(DARK.get(c, c), PAPER) < 2.0}
    assert not faint


def test_legend_and_style_name_the_same_variable() -> None:
    variable = re.search(r"var\((--c-\w+),#1b2430\)", legend((("measured", "#1b2430", "line"),)))
    assert variable is not None
    assert f"{variable.group(1)}:{DARK['#1b2430']}" in dark_style()
    assert "prefers-color-scheme: dark" in dark_style()


def test_colour_without_a_twin_stays() -> None:
    assert css_colour("#e69f00") == "#e69f00"
