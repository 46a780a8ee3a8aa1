# SPDX-License-Identifier: Apache-2.0
"""Only what is new is learned, what fails is told, and what is learned is kept at once."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from pathlib import Path

import pytest
from fleet.work_samples import sample_rows

from slipwise.calibration import Settings
from slipwise.fleet import LogTask, Outcome, Store
from slipwise.fleet.learn_fleet import Progress, learn_fleet
from slipwise.fleet.learned_rows import key_of, settings_hash


class Here:
    """Learns in this process: rows of the task's own key; fails on logs named so."""

    def run(self, tasks: Iterable[LogTask]) -> Generator[Outcome, None, None]:
        for task in tasks:
            if Path(task.path).stem == "stops":
                raise KeyboardInterrupt
            if Path(task.path).stem == "fails":
                yield Outcome(task, None, "as it was told")
                continue
            rows = sample_rows(task.path, key=key_of(task.log_sha256, settings_hash(Settings())))
            yield Outcome(task, rows)


def logs(folder: Path, *names: str) -> list[tuple[Path, str]]:
    """Write logs that differ by their names."""
    for name in names:
        (folder / f"{name}.csv").write_text(name, encoding="utf-8")
    return [(folder / f"{name}.csv", "one") for name in names]


def test_second_run_learns_only_what_is_new(tmp_path: Path) -> None:
    store = Store(tmp_path / "fleet")
    first = learn_fleet(logs(tmp_path, "a", "b"), store, Here())
    second = learn_fleet(logs(tmp_path, "a", "b", "c"), store, Here())
    assert (first.learned, first.known) == (2, 0)
    assert (second.learned, second.known) == (1, 2)


def test_copy_of_a_log_is_the_same_log(tmp_path: Path) -> None:
    (found,) = logs(tmp_path, "a")
    copy = tmp_path / "copy.csv"
    copy.write_bytes(found[0].read_bytes())
    store, said = (
        Store(tmp_path / "fleet"),
        f"the same log as {found[0]}, and counts once, not for both one and two",
    )
    count = learn_fleet([found, (copy, "two")], store, Here())
    assert (count.learned, count.known) == (1, 1)
    assert count.copies == ((str(copy), said),)
    again = learn_fleet([found, (copy, "one")], store, Here())
    assert again.copies == ((str(copy), f"the same log as {found[0]}"),)
    assert learn_fleet([found], store, Here()).copies == ()


def test_log_that_fails_is_told_and_tried_again(tmp_path: Path) -> None:
    store = Store(tmp_path / "fleet")
    for _ in range(2):
        count = learn_fleet(logs(tmp_path, "fails"), store, Here())
        assert count.failed == ((str(tmp_path / "fails.csv"), "as it was told"),)


def test_log_that_is_gone_is_told(tmp_path: Path) -> None:
    count = learn_fleet([(tmp_path / "gone.csv", "one")], Store(tmp_path / "fleet"), Here())
    assert "No such file" in count.failed[0][1]


def test_interrupt_keeps_what_was_learned_before(tmp_path: Path) -> None:
    store = Store(tmp_path / "fleet")
    with pytest.raises(KeyboardInterrupt):
        learn_fleet(logs(tmp_path, "a", "stops", "c"), store, Here())
    assert len(store.keys()) == 1
    assert store.table()["parameter"].tolist() == ["ang.w", "lon.V"]


def test_progress_counts_all_logs_and_ends_with_none_left(tmp_path: Path) -> None:
    told: list[Progress] = []
    found = logs(tmp_path, "a", "fails", "b")
    learn_fleet(found, Store(tmp_path / "fleet"), Here(), progress=told.append)
    assert [now.done for now in told] == [1, 2, 3]
    assert told[-1].seconds_left == 0.0
