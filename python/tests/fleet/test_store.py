# SPDX-License-Identifier: Apache-2.0
"""Rows stand by vehicle and month, and what was learned is known again."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest
from fleet.work_samples import sample_rows

from slipwise.fleet import Row, Store, findings_of
from slipwise.fleet.fleet_page import summary
from slipwise.fleet.vehicle_numbers import NAMES, VehicleNumbers

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


def test_log_learned_with_other_settings_counts_once(tmp_path: Path) -> None:
    """The rows of the settings that are asked for count, else those that were learned last."""
    first, other = sample_rows(), sample_rows(key="0123456789abcdef-fedcba9876543210", failure="no", rows=())
    asked = Store(tmp_path, "0123456789abcdef" * 4)
    asked.add(first)
    os.utime(asked.add(other), ns=(2**62, 2**62))
    assert len(asked.table()["key"]) == 2
    assert asked.unusable() == []
    last = Store(tmp_path)
    assert last.table() == {}
    assert len(last.unusable()) == 1


def test_logs_of_other_inputs_have_parameters_of_their_own(tmp_path: Path) -> None:
    """Slip of 0.1 behind a drive of 0.8 and slip of 0.28 without wheel speeds are one robot."""
    store = Store(tmp_path)
    gain = Row("gain_v", "-", 0.8, 0.01, 0.2, True)
    for k in range(2):
        store.add(sample_rows(key=f"{k:016x}-0123456789abcdef", rows=(*sample_rows().rows, gain)))
    alone = Row("lon.V", "m/s per V", -0.28, 0.02, 0.3, True)
    store.add(sample_rows(key=OTHER, vehicle="two", rows=(alone,)))
    table = store.table()
    names = {name: set(table["parameter"][table["vehicle"] == name]) for name in ("one", "two")}
    assert names == {"one": {"ang.w", "lon.V", "gain_v"}, "two": {"lon.V (commands alone)"}}
    said = "Logs were learned 2 from commands and wheel speeds, 1 from commands alone: each is compared with"
    assert any(text.startswith(said) for text in summary(table, findings_of(table), []))


def test_rows_of_an_older_version_have_no_numbers_of_the_vehicle(tmp_path: Path) -> None:
    store = Store(tmp_path)
    path = store.add(sample_rows(numbers=VehicleNumbers(turns=0.5)))
    assert store.table()["turns"].tolist() == [0.5, 0.5]
    parquet.write_table(parquet.read_table(path).drop_columns(list(NAMES)), path)
    assert np.isfinite(store.table()["value"]).all()
    assert np.isnan(store.table()["turns"]).all()


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


KNOWN = (
    '{"input": "wheel", "kept": "joint", "structures": {"joint": {"speeds": [1.0, 0.5], "robot_names": [], '
    '"robot": null, "bases": {"edd-2": {"weight": 1.0, "noise_scale": [1, 1, 1], "slip": {"mean": [0.1], '
    '"covariance": [[0.01]], "prior_mean": [0.0], "prior_std": [0.3]}}}}}}'
)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-20])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def nonsense(path: Path) -> None:
    path.write_text(path.read_text().replace("0.01", "NaN"))


@pytest.mark.parametrize(
    ("pattern", "damage"),
    [
        ("rows/*/*/*.parquet", cut),
        ("rows/*/*/*.parquet", empty),
        ("knowledge/*/*.json", nonsense),
        ("knowledge/*/*.json", cut),
        ("unusable/*.json", empty),
    ],
)
def test_a_damaged_file_is_set_aside_said_and_its_log_learned_again(
    tmp_path: Path, pattern: str, damage: Callable[[Path], None]
) -> None:
    store = Store(tmp_path)
    sound, damaged, third = (f"{k:016x}-{0:016x}" for k in (1, 2, 3))
    for key in (sound, damaged):
        store.add(sample_rows(key=key, knowledge=KNOWN))
    store.add(sample_rows(key=third, rows=(), failure="no poses"))
    assert store.mend() == []
    key = third if pattern.startswith("unusable") else damaged
    (path,) = (path for path in tmp_path.glob(pattern) if path.stem == key)
    damage(path)
    (said,) = store.mend()
    assert str(path) in said
    assert "learned again" in said
    assert store.keys() == {sound, damaged, third} - {key}
    assert (tmp_path / "set-aside" / path.name).exists()
    assert len(store.table()["key"]) == 2 * (2 - (key == damaged))
    assert len(store.unusable()) == 1 - (key == third)
    assert store.mend() == []


def test_a_long_name_of_a_vehicle_is_shortened_and_stays_its_own(tmp_path: Path) -> None:
    store = Store(tmp_path)
    names = ["v" * 240, "v" * 239 + "w", "\u8eca" * 80, "short"]
    for k, name in enumerate(names):
        store.add(sample_rows(key=f"{k:016x}-{0:016x}", vehicle=name, knowledge=KNOWN))
    found = set(store.table()["vehicle"].tolist())
    assert len(found) == len(names)
    assert "short" in found
    assert {vehicle for vehicle, _ in store.knowledge()} == found
