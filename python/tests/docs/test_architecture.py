# SPDX-License-Identifier: Apache-2.0
"""The page of files names every source file, and no other; the tour is short and names what exists."""

import re
from pathlib import Path

import pytest
from docs.write_files_page import (
    PAGE,
    ROOT,
    folders_named,
    folders_needed,
    rewritten,
    sentence_of,
    source_files,
)
from tools.check_includes import LAYERS

TOUR = ROOT / "ARCHITECTURE.md"
LONGEST_TOUR = 150  # lines
REWRITE = "run python docs/write_files_page.py"


def test_every_folder_with_sources_has_a_table() -> None:
    missing = folders_needed() - folders_named(PAGE.read_text(encoding="utf-8"))
    assert not missing, f"add tables to docs/files.md, then {REWRITE}"


def test_tables_name_all_files_with_their_own_sentence() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert rewritten(text) == text, REWRITE


def test_every_source_file_starts_with_a_sentence() -> None:
    files = [path for folder in sorted(folders_needed()) for path in source_files(ROOT / folder)]
    silent = [str(path.relative_to(ROOT)) for path in files if not sentence_of(path).endswith(".")]
    assert not silent


def test_tour_can_be_read_in_one_sitting() -> None:
    assert len(TOUR.read_text(encoding="utf-8").splitlines()) <= LONGEST_TOUR


@pytest.mark.parametrize("page", [TOUR, PAGE], ids=lambda page: page.name)
def test_every_path_named_exists(page: Path) -> None:
    text = re.sub(r"<!-- files.*?<!-- end -->", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    named = set(re.findall(r"`([\w./]+/|[\w./]+\.(?:py|hpp|cpp|cu|sh|css|js))`", text))
    tops = [ROOT / "python", ROOT / "cpp"]
    places = [ROOT, *tops, *(path for top in tops for path in top.rglob("*") if path.is_dir())]
    gone = {name for name in named if not any((place / name).exists() for place in places)}
    assert len(named) > 5
    assert not gone


def test_layers_of_the_tour_are_those_that_are_checked() -> None:
    block = re.search(
        r"^C\+\+ +(archive.*?)^Python", TOUR.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    assert block
    rows = [tuple(name.strip() for name in row.split("|")) for row in block[1].split("<")]
    assert rows == list(LAYERS)
