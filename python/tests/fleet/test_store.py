# SPDX-License-Identifier: Apache-2.0
"""Rows stand by vehicle and month, and what was learned is known again."""

from __future__ import annotations

from pathlib import Path

from fleet.work_samples import sample_rows

from slipwise.fleet import Store

OTHER = "fedcba9876543210-0123456789abcdef"


def test_rows_stand_by_vehicle_and_month(tmp_path: Path) -> None:
    path = Store(tmp_path).add(sample_rows())
    assert path.relative_to(tmp_path).parts[:3] == ("rows", "vehicle=one", "month=2026-11")


def test_table_holds_a_row_per_log_and_parameter(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.add(sample_rows())
    store.add(sample_rows("second", key=OTHER, vehicle="042", month="2026-12", start=1.8e9))
    table = store.table()
    assert table["vehicle"].tolist() == ["042", "042", "one", "one"]
    assert table["parameter"].tolist() == ["ang.w", "lon.V"] * 2
    assert table["value"].tolist() == [-0.3, -0.1] * 2
    assert table["month"].tolist() == ["2026-12", "2026-12", "2026-11", "2026-11"]


def test_unusable_log_keeps_its_reason_and_is_known(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.add(sample_rows(rows=(), failure="no poses"))
    assert store.unusable()[0]["failure"] == "no poses"
    assert store.keys() == {"0123456789abcdef-0123456789abcdef"}
    assert store.table() == {}


def test_name_of_a_vehicle_cannot_leave_the_folder(tmp_path: Path) -> None:
    store = Store(tmp_path)
    path = store.add(sample_rows(vehicle="../../x/y é"))
    assert (tmp_path / "rows").resolve() in path.resolve().parents
    assert set(store.table()["vehicle"].tolist()) == {"../../x/y é"}


def test_file_of_another_kind_or_in_the_making_is_no_key(tmp_path: Path) -> None:
    store = Store(tmp_path)
    path = store.add(sample_rows())
    path.with_name("notes.parquet").touch()
    in_the_making = path.parent / ".slipwise-00000000.part" / f"{OTHER}.parquet"
    in_the_making.parent.mkdir()
    in_the_making.touch()
    assert store.keys() == {"0123456789abcdef-0123456789abcdef"}


def test_of_too_many_logs_each_vehicle_has_equally_many(tmp_path: Path) -> None:
    store = Store(tmp_path)
    for vehicle, logs in (("one", 6), ("two", 2), ("three", 1)):
        for k in range(logs):
            text = '{"input": "wheel", "kept": "joint", "structures": {}}'
            store.add(sample_rows(vehicle=vehicle, key=f"{k:016x}-{0:016x}", knowledge=text))
    assert len(store.knowledge()) == 9
    assert sorted(vehicle for vehicle, _ in store.knowledge(5)) == ["one", "one", "three", "two", "two"]
