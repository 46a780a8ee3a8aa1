# SPDX-License-Identifier: Apache-2.0
"""What each colour of the page and its figures becomes where the browser asks for a dark page.

The light colours stand where they are used. The page declares a CSS variable for each that changes; its
script reads the same variables when it draws the figures.
"""

from __future__ import annotations

DARK = {
    # ink and paper
    "#1b2430": "#e3e8ee",
    "#566270": "#a3afbc",
    "#7b8794": "#94a1ae",
    "#8a94a0": "#98a4b1",
    "#9aa5b1": "#74808d",
    "#c3cad3": "#4a5663",
    "#d5dbe1": "#38434f",
    "#e6eaef": "#2a333d",
    "#f7f9fa": "#1d242d",
    "#ffffff": "#171d25",
    "#0b5c8a": "#6db8e8",
    # methods
    "#d55e00": "#ff8b3d",
    "#b8860b": "#d8a838",
    "#0072b2": "#4fa9e2",
    "#009e73": "#2ec598",
    "#8c6d31": "#c2a05c",
    "#4d4d4d": "#b4b4b4",
    "#a63603": "#e8794a",
    "#7a4fa3": "#b491de",
    "#3f5fa8": "#8aa5ea",
    # a plan
    "#9fd6c2": "#3f8a72",
    "#00694d": "#58d9b0",
    # the band of mean NIS
    "#e6d6ad": "#4d4223",
    # slip, diverging: dark where there is none
    "#d6604d": "#d6604d",
    "#f4a582": "#8a4334",
    "#f7f7f7": "#1d242d",
    "#92c5de": "#2c5f7e",
    "#4393c3": "#4393c3",
}


def css_colour(colour: str) -> str:
    """Return `#rrggbb` so that CSS shows its dark twin on a dark page."""
    return f"var({_variable(colour)},{colour})" if colour in DARK else colour


def dark_style() -> str:
    """Return the style sheet that declares the dark twins."""
    declared = ";".join(f"{_variable(light)}:{dark}" for light, dark in DARK.items())
    return f"@media screen and (prefers-color-scheme: dark){{:root{{{declared}}}}}"


def _variable(colour: str) -> str:
    return f"--c-{colour.removeprefix('#')}"
