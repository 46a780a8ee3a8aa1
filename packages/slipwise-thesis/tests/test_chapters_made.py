# SPDX-License-Identifier: Apache-2.0
"""Chapters are made in other processes, in order, with progress; what fails there fails here."""

from __future__ import annotations

from pathlib import Path

import pytest
from toy_chapters import FAILING, TOY

from slipwise.errors import SettingsError
from slipwise_thesis import CHAPTERS, SMALL, reproduce
from slipwise_thesis.chapters import FixturePlan, chosen_chapters

pytestmark = pytest.mark.slow

PLAN = FixturePlan(size=SMALL)


def test_chapters_come_back_in_their_order_and_report_progress(tmp_path: Path) -> None:
    reported: list[tuple[str, float]] = []
    plan = FixturePlan(size=SMALL, data=tmp_path)
    made = reproduce(plan, chapters=(TOY,), progress=lambda what, fraction: reported.append((what, fraction)))
    assert [chapter.key for chapter in made] == ["toy"]
    assert [figure.key for figure in made[0].figures] == ["figure-9-1", "figure-9-2", "figure-9-3"]
    assert f"({tmp_path})" in made[0].figures[2].missing
    assert ("toy: half", 0.5) in reported
    assert reported[-1] == ("done", 1.0)


def test_an_error_in_a_chapter_says_what_where_and_what_to_do() -> None:
    with pytest.raises(SettingsError) as caught:
        reproduce(PLAN, chapters=(FAILING,))
    assert str(caught.value) == "a chapter went wrong (toy): mend it"


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(SettingsError, match="-1"):
        reproduce(FixturePlan(seed=-1))


def test_chapters_are_chosen_by_key_and_unknown_ones_are_named() -> None:
    assert chosen_chapters([]) == CHAPTERS
    assert [chapter.key for chapter in chosen_chapters(["chapter-4", "chapter-2"])] == [
        "chapter-2",
        "chapter-4",
    ]
    with pytest.raises(SettingsError, match="chapter-9"):
        chosen_chapters(["chapter-9"])


def test_keys_of_chapters_are_unique() -> None:
    keys = [chapter.key for chapter in CHAPTERS]
    assert len(set(keys)) == len(keys)
