# SPDX-License-Identifier: Apache-2.0
"""Pictures are drawn where Matplotlib is installed; where it is not, a command works and says so."""

from __future__ import annotations

PICTURE_HELP = "Draw the PNG; by default where Matplotlib is installed."


def missing_picture(asked: bool | None, what: str = "The picture") -> str:
    """Return the sentence that says why no picture is drawn, empty where nothing is missing.

    Args:
        asked: whether a picture was asked for; None leaves it to what is installed.
        what: what is not there without Matplotlib.

    Raises:
        SlipwiseError: it was asked for, and Matplotlib is not installed.
    """
    from slipwise.reporting.png_picture import ADVICE, can_draw, drawing_part

    if asked is False or can_draw():
        return ""
    if asked:
        drawing_part("figure")  # says what is missing
    return f"{what} was left out: it needs Matplotlib ({ADVICE})."
