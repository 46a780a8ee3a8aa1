# SPDX-License-Identifier: Apache-2.0
"""Writes the figures and tables as one HTML page, and as Markdown with pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from slipwise.files import write_text_whole, write_whole
from slipwise.reporting.png_picture import can_draw
from slipwise_thesis.chapters import ChapterResult
from slipwise_thesis.draw_page import draw_page
from slipwise_thesis.draw_png import draw_png
from slipwise_thesis.markdown import markdown


def write_reproduction(folder: Path, chapters: Sequence[ChapterResult]) -> dict[str, Path]:
    """Write `index.html`, and `markdown/README.md` with a PNG per drawn figure beside it.

    Without Matplotlib, which draws the pictures, the Markdown is left out.

    Returns:
        The documents by the names "page" and "markdown".

    Raises:
        OutputError: a file cannot be written.
    """
    files = {"page": folder / "index.html"}
    write_text_whole(files["page"], draw_page(chapters))
    if not can_draw():
        return files
    files["markdown"] = folder / "markdown" / "README.md"
    for chapter in chapters:
        for figure in chapter.figures:
            if figure.panels:
                picture = draw_png(figure)
                write_whole(
                    files["markdown"].with_name(f"{figure.key}.png"),
                    lambda path, picture=picture: _write_bytes(path, picture),  # type: ignore[misc]
                )
    write_text_whole(files["markdown"], markdown(chapters))
    return files


def _write_bytes(path: Path, content: bytes) -> None:
    path.write_bytes(content)
