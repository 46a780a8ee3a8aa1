# SPDX-License-Identifier: Apache-2.0
"""The tour of the sources names every source file, and no other."""

import re

from docs.write_architecture import (
    PAGE,
    ROOT,
    folders_named,
    folders_needed,
    rewritten,
    sentence_of,
    source_files,
)

REWRITE = "run python docs/write_architecture.py"


def test_every_folder_with_sources_has_a_table() -> None:
    missing = folders_needed() - folders_named(PAGE.read_text(encoding="utf-8"))
    assert not missing, f"add tables to ARCHITECTURE.md, then {REWRITE}"


def test_tables_name_all_files_with_their_own_sentence() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert rewritten(text) == text, REWRITE


def test_every_source_file_starts_with_a_sentence() -> None:
    files = [path for folder in sorted(folders_needed()) for path in source_files(ROOT / folder)]
    silent = [str(path.relative_to(ROOT)) for path in files if not sentence_of(path).endswith(".")]
    assert not silent


def test_every_path_named_in_the_tour_exists() -> None:
    text = re.sub(r"<!-- files.*?<!-- end -->", "", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    named = set(re.findall(r"`([\w./]+/|[\w./]+\.(?:py|hpp|cpp|sh|css|js))`", text))
    places = [ROOT, ROOT / "python", *(path for path in (ROOT / "python").rglob("*") if path.is_dir())]
    gone = {name for name in named if not any((place / name).exists() for place in places)}
    assert "tools/check_files.py" in named
    assert not gone
