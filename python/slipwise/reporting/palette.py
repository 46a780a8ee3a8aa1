# SPDX-License-Identifier: Apache-2.0
"""One colour and line per method in every figure, distinct for the colour-blind (Okabe and Ito 2008)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from slipwise.reporting.contents import LEARNED, MAIN_METHODS, PLAIN, SIMPLE, VENDOR
from slipwise.reporting.dark_colours import css_colour

MEASURED = "#1b2430"
BAND = "#c3cad3"
ALARM_COLOUR = "#e69f00"  # a change of terrain
# Slip: red negative, white none, blue positive (ColorBrewer RdBu without its dark ends: labels stay legible).
DIVERGING: list[tuple[float, str]] = [
    (0.0, "#d6604d"),
    (0.25, "#f4a582"),
    (0.5, "#f7f7f7"),
    (0.75, "#92c5de"),
    (1.0, "#4393c3"),
]
SEQUENTIAL = "Viridis"  # time and amounts


@dataclass(frozen=True)
class Stroke:
    """How a method is drawn."""

    colour: str
    dash: str  # Plotly's name
    symbol: str  # Plotly's name


_STROKES = {
    PLAIN: Stroke("#d55e00", "dash", "circle-open"),
    VENDOR: Stroke("#b8860b", "dashdot", "diamond-open"),
    SIMPLE: Stroke("#0072b2", "dot", "square-open"),
    LEARNED: Stroke("#009e73", "solid", "circle"),
}
LEARNED_STROKE = _STROKES[LEARNED]
_OTHERS = ("#cc79a7", "#56b4e9", "#7a4fa3", "#8c6d31", "#d1a800", "#4d4d4d", "#a63603", "#66a61e", "#3f5fa8")

_SURFACES = (
    "#0072b2",
    "#009e73",
    "#cc79a7",
    "#d1a800",
    "#56b4e9",
    "#7a4fa3",
    "#a63603",
    "#66a61e",
    "#8c6d31",
)


def stroke_of(method: str, methods: Sequence[str]) -> Stroke:
    """Return how `method` is drawn; the others' colours follow the order in `methods`."""
    if method in _STROKES:
        return _STROKES[method]
    others = [name for name in methods if name not in MAIN_METHODS]
    place = others.index(method) if method in others else len(others)
    return Stroke(_OTHERS[place % len(_OTHERS)], "solid", "circle")


def surface_colour(place: int) -> str:
    """Return the colour of the surface that was driven on in this place, counted from 0."""
    return _SURFACES[place % len(_SURFACES)]


def transparent(colour: str, opacity: float) -> str:
    """Return `#rrggbb` as an rgba() colour."""
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity:g})"


def css_swatch(colour: str) -> str:
    """Return the style of a small square in a colour."""
    return f"background:{css_colour(colour)}"
