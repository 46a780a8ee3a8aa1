# SPDX-License-Identifier: Apache-2.0
"""The strict check finds each departure from the format of shared logs, and says where it is."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as parquet
import pytest
from sample_logs import Drive, simulated_log

from slipwise.errors import LogError
from slipwise.inspection import Stated, check_strictly, files_beside, write_beside
from slipwise.logs import anonymised, save_log


@pytest.fixture(scope="module")
def _set(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("set")
    save_log(anonymised(simulated_log(Drive(seconds=30.0))), folder / "a.parquet")
    stated = Stated("CC0-1.0", "simulated", "simulated")
    write_beside(folder / "a.parquet", stated, anonymised=True, progress=lambda *_: None)
    return folder


@pytest.fixture
def table(_set: Path, tmp_path: Path) -> Path:
    shutil.copytree(_set, tmp_path, dirs_exist_ok=True)
    return tmp_path / "a.parquet"


def found(table: Path) -> set[str]:
    return {departure.kind for departure in check_strictly(table)}


def replaced(name: str, change: Callable[[list], list], kind: pa.DataType | None = None):  # type: ignore[type-arg, no-untyped-def]
    def damage(arrow: pa.Table) -> pa.Table:
        at = arrow.column_names.index(name)
        values = change(arrow.column(name).to_pylist())
        return arrow.set_column(at, name, pa.array(values, kind or arrow.schema.field(name).type))

    return damage


def one(row: int, value: object) -> Callable[[list], list]:  # type: ignore[type-arg]
    return lambda values: [value if k == row else each for k, each in enumerate(values)]


DAMAGES = {
    "column-missing": lambda arrow: arrow.drop_columns(["yaw"]),
    "column-type": replaced("x", lambda v: v, pa.float32()),
    "empty-cell": replaced("run", one(3, None)),
    "non-finite": replaced("cmd_v", one(3, float("nan"))),
    "stamp-order": replaced("t", one(3, 0.0)),
    "run-in-pieces": replaced("run", one(3, "other")),
    "pose-new": replaced("pose_new", one(3, 2)),
    "pose-part": replaced("y", one(3, None)),
    "twist-part": replaced("odo_omega", one(3, None)),
    "not-anonymised": lambda arrow: arrow.set_column(
        arrow.column_names.index("x"), "x", pc.add(arrow.column("x"), 5.0)
    ),
}


def test_a_sound_set_departs_from_nothing(table: Path) -> None:
    assert check_strictly(table) == ()


@pytest.mark.parametrize("kind", DAMAGES)
def test_each_departure_of_the_table_is_found(table: Path, kind: str) -> None:
    parquet.write_table(DAMAGES[kind](parquet.read_table(table)), table)
    kinds = found(table)
    assert kind in kinds
    assert "card" in kinds  # its hash is of another table


def test_a_negative_deviation_is_found(table: Path) -> None:
    arrow = parquet.read_table(table)
    parquet.write_table(arrow.append_column("std_xy", pa.array([-1.0] * len(arrow))), table)
    assert {"negative-std", "schema"} <= found(table)


@pytest.mark.parametrize("name", ["licence", "vehicle", "sensors"])
def test_what_nobody_stated_is_a_departure(table: Path, name: str) -> None:
    card = files_beside(table)["card"]
    lines = [
        f"{name}: not stated" if line.startswith(f"{name}:") else line
        for line in card.read_text().splitlines()
    ]
    card.write_text("\n".join(lines))
    (departure,) = check_strictly(table)
    assert departure.what == f"the {name} is not stated"


@pytest.mark.parametrize(
    "content", [b"{", b"\xff", b"[" * 100_000, b"[]", json.dumps({"fields": []}).encode()]
)
def test_a_schema_file_of_something_else_is_a_departure(table: Path, content: bytes) -> None:
    files_beside(table)["schema"].write_bytes(content)
    assert found(table) == {"schema"}


def test_files_that_are_missing_are_departures(table: Path) -> None:
    for path in files_beside(table).values():
        path.unlink()
    assert found(table) == {"schema", "card"}


def test_what_is_no_parquet_file_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "a.parquet").write_bytes(b"PAR1 and no more")
    with pytest.raises(LogError, match="not a readable Parquet file"):
        check_strictly(tmp_path / "a.parquet")
    with pytest.raises(LogError, match="no such file"):
        check_strictly(tmp_path / "b.parquet")
