# SPDX-License-Identifier: Apache-2.0
"""Pictures as PNG by Matplotlib, which is loaded only here, and only when one is drawn."""

from __future__ import annotations

import importlib
import importlib.util
import io
from typing import Any

from slipwise.errors import SlipwiseError
from slipwise.extras import to_install

ADVICE = to_install("plot")
_COLOURS = (128, 64, 32, 16)  # of a picture's palette, the most first


def can_draw() -> bool:
    """Return whether Matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def drawing_part(name: str) -> Any:
    """Return a module of Matplotlib, such as "figure".

    Raises:
        SlipwiseError: Matplotlib is not installed.
    """
    if not can_draw():
        raise SlipwiseError("pictures need Matplotlib, which is not installed", advice=ADVICE)
    return importlib.import_module(f"matplotlib.{name}")


def small_png(figure: Any, *, dpi: int, largest: int) -> bytes:
    """Return a figure as PNG with as many colours as fit into `largest` bytes, 16 at the least."""
    from PIL import Image  # Matplotlib brings it

    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=dpi, metadata={"Software": None})
    image = Image.open(drawn).convert("RGB")
    for colours in _COLOURS:
        small = io.BytesIO()
        image.quantize(colours, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(
            small, format="png", optimize=True
        )
        if small.tell() <= largest:
            break
    return small.getvalue()
