# SPDX-License-Identifier: Apache-2.0
"""Every source file says what it is for; the tour is short and names what exists."""

import re

from docs.files_page import ROOT, page, sentence_of, sources
from tools.check_includes import LAYERS

TOUR = ROOT / "ARCHITECTURE.md"
LONGEST_TOUR = 150  # lines


def test_every_source_file_starts_with_a_sentence() -> None:
    files = [path for _, path in sources()]
    assert len(files) > 500
    assert [str(path.relative_to(ROOT)) for path in files if not sentence_of(path).endswith(".")] == []
    assert "| `cholesky.hpp`, `cholesky.cpp` | Cholesky factors" in page()


def test_tour_can_be_read_in_one_sitting() -> None:
    assert len(TOUR.read_text(encoding="utf-8").splitlines()) <= LONGEST_TOUR


def test_every_path_named_exists() -> None:
    text = TOUR.read_text(encoding="utf-8")
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
