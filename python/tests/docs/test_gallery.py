# SPDX-License-Identifier: Apache-2.0
"""The gallery's pictures are small and made by a script, and what it says of each log is what comes out."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from docs.figures.make_gallery import LARGEST, REPORTS, Shown, alone, main, trimmed
from python.tests.docs.pages import ROOT, blocks

import slipwise as sw

PAGE = ROOT / "docs/results.md"


def test_every_picture_is_shown_small_and_made_by_the_script() -> None:
    text = PAGE.read_text(encoding="utf-8")
    made = {name for shown in REPORTS for name in shown.pictures}
    assert made == {path.name for path in (ROOT / "docs/figures").glob("gallery-*.png")}
    for name in made:
        assert f"(figures/{name})" in text
        assert (ROOT / "docs/figures" / name).stat().st_size <= LARGEST


def test_commands_of_the_page_are_those_of_the_script() -> None:
    lines = [shlex.split(line) for block in blocks(PAGE, "sh") for line in block.splitlines()]
    made = [["slipwise", "calibrate", f"{shown.log}.csv.gz", *shown.options] for shown in REPORTS]
    assert lines == made


def test_without_logs_the_script_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SLIPWISE_DATA", raising=False)
    with pytest.raises(SystemExit, match="SLIPWISE_DATA is not set"):
        main(tmp_path)


def test_one_section_is_shown_unfolded() -> None:
    section = '<details class="section" id="section-4"><summary><h2>Errors</h2></summary></details>'
    page = alone(f"<html><head></head><body>{section}</body></html>", "Errors")
    assert '<details class="section" id="section-4" open>' in page
    assert "#section-4[id] { display: block" in page


def test_a_picture_ends_where_the_page_is_empty(tmp_path: Path) -> None:
    images = pytest.importorskip("PIL.Image")
    picture = images.new("RGB", (100, 300), "white")
    picture.paste("black", (10, 10, 90, 50))
    picture.save(tmp_path / "page.png")
    (tmp_path / "small.png").write_bytes(trimmed(tmp_path / "page.png"))
    assert images.open(tmp_path / "small.png").size == (100, 62)


@pytest.mark.slow
@pytest.mark.parametrize("shown", REPORTS, ids=lambda shown: shown.log)
def test_the_verdict_is_that_of_the_page(shown: Shown, real_log_dir: Path) -> None:
    end = float(shown.options[shown.options.index("--end") + 1]) if "--end" in shown.options else None
    log = sw.open_log(real_log_dir / f"{shown.log}.csv.gz", options=sw.LogOptions(end=end))
    assert sw.calibrate(log, input=shown.options[1]).verdict.good == (shown.code == 0)
