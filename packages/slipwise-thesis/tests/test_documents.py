# SPDX-License-Identifier: Apache-2.0
"""The Markdown, the pictures and the page: everything is in them, small, and the same bytes each time."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from reporting.page_parts import figures_of, text_of
from toy_chapters import toy_results

from slipwise.errors import OutputError
from slipwise_thesis import write_reproduction
from slipwise_thesis.draw_page import draw_page
from slipwise_thesis.draw_png import LARGEST, draw_png
from slipwise_thesis.markdown import markdown

pytestmark = pytest.mark.slow

pytest.importorskip("matplotlib")


def test_markdown_holds_every_figure_with_its_picture_table_and_words() -> None:
    text = markdown(toy_results())
    assert "### Figure 9.9: Toy figure-9-1" in text
    assert "![Figure 9.9: Toy figure-9-1](figure-9-1.png)" in text
    assert "| a\\|b | 1 |\n| c\\_d | 2 |" in text
    assert "**Agrees.** It agrees." in text
    assert "**Differs.** It \\| differs." in text
    assert "What \\<b>is\\</b> shown." in text
    assert "Not made: the log nobody/has\\_this is missing" in text


def test_links_of_the_contents_lead_to_headings() -> None:
    text = markdown(toy_results())
    headings = re.findall(r"^### (.*)$", text, re.MULTILINE)
    anchors = re.findall(r"\]\(#([^)]+)\)", text)
    made = ["".join(c for c in h.lower() if c in " -_" or c.isalnum()).replace(" ", "-") for h in headings]
    assert anchors == made


def test_pictures_are_small_and_the_same_bytes_each_time() -> None:
    from PIL import Image

    for figure in toy_results()[0].figures[:2]:
        picture = draw_png(figure)
        assert picture == draw_png(figure)
        assert len(picture) <= LARGEST
        assert Image.open(io.BytesIO(picture)).width > 600
        assert b"matplotlib" not in picture.lower()


def test_page_draws_every_panel_says_every_word_and_forbids_every_request() -> None:
    html = draw_page(toy_results())
    assert html == draw_page(toy_results())
    assert list(figures_of(html)) == [f"figure-figure-9-{e}-{p}" for e in (1, 2) for p in (1, 2, 3)]
    assert "default-src 'none'" in html
    seen = text_of(html)
    for words in ("What &lt;b&gt;is&lt;/b&gt; shown.", "It agrees.", "Differs, and why.", "a|b", "A note."):
        assert words in seen
    assert "Not made: the log nobody/has_this is missing" in seen
    for figure in toy_results()[0].figures:
        assert f'href="#{figure.key}"' in html
        assert f'id="{figure.key}"' in html


def test_everything_is_written_whole(tmp_path: Path) -> None:
    files = write_reproduction(tmp_path / "out", toy_results())
    names = {str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*.*")}
    assert names == {"index.html", "markdown/README.md", "markdown/figure-9-1.png", "markdown/figure-9-2.png"}
    assert files["markdown"].read_text(encoding="utf-8") == markdown(toy_results())
    (tmp_path / "file").touch()
    with pytest.raises(OutputError):
        write_reproduction(tmp_path / "file", toy_results())
