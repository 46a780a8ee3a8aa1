# SPDX-License-Identifier: Apache-2.0
"""Checks that a shared log keeps to the standard format: its table, its schema file and its data card."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from slipwise.errors import LogError
from slipwise.files import read_whole, sha256_of
from slipwise.inspection.data_card import NOT_STATED, DataCard, card_path, read_card
from slipwise.logs import Log, LogOptions, open_log
from slipwise.logs.left_out import Tally
from slipwise.logs.table import Table, read_parquet
from slipwise.logs.vocabulary import BY_NAME, SHARED, table_schema

if TYPE_CHECKING:
    import pyarrow as pa

_MOST_SCHEMA = 1 << 20  # bytes
_NEEDED = ("run", "t", "x", "y", "yaw", "pose_new")
_TWISTS = (("cmd_v", "cmd_omega"), ("odo_v", "odo_omega"))
_TYPES = {"string": "string", "number": "double", "integer": "int64"}
_ORIGIN = 1e-9  # m, rad, s; where an anonymised run begins


@dataclass(frozen=True)
class Departure:
    """Something that is not as the format asks."""

    kind: str  # a short stable name, such as "column-type"
    what: str
    where: str


def schema_path(table: Path) -> Path:
    """Where the schema file of a table is."""
    return table.with_name(f"{table.stem}.schema.json")


def schema_of(table: Table) -> dict[str, Any]:
    """Return the Table Schema of a table's columns."""
    arrow = table.arrow
    return table_schema(arrow.column_names, [f.name for f in arrow.schema if str(f.type) != "string"])


def check_strictly(path: Path) -> tuple[Departure, ...]:
    """Return all that departs from the format; an empty tuple if a table keeps to it.

    Raises:
        LogError: there is no such file, or it is no Parquet file at all.
    """
    if not path.is_file():
        raise LogError("no such file", where=str(path), advice="--strict checks one Parquet file")
    table = read_parquet(path, columns={})
    found = [*_columns(table.arrow, path), *_cells(table)]
    if not found:
        found += _rows(table)
    log: Log | None = None
    try:
        log = open_log(path, options=LogOptions())
        found += [Departure("left-out", f"{item.count} x {item.reason}", item.where) for item in log.left_out]
    except LogError as problem:
        found.append(Departure("unreadable", problem.what, problem.where))
    return (*found, *_beside(path, table, log))


def _columns(arrow: pa.Table, path: Path) -> Iterator[Departure]:
    names = arrow.column_names
    for name in (name for name in _NEEDED if name not in names):
        yield Departure("column-missing", f"there is no column {name}", path.name)
    if not any(all(name in names for name in pair) for pair in _TWISTS):
        yield Departure("column-missing", "neither cmd_v and cmd_omega nor odo_v and odo_omega", path.name)
    for pair in _TWISTS:
        if sum(name in names for name in pair) == 1:
            yield Departure("column-missing", f"one of {' and '.join(pair)} alone", path.name)
    for column in SHARED:
        if column.name in names and str(arrow.schema.field(column.name).type) != _TYPES[column.type]:
            kind = arrow.schema.field(column.name).type
            yield Departure("column-type", f"{column.name} is {kind}, not {_TYPES[column.type]}", path.name)


def _cells(table: Table) -> Iterator[Departure]:
    """Empty cells where there may be none, and numbers that are none."""
    tally = Tally()
    for name in table.names:
        column, kind = table.arrow.column(name), str(table.arrow.schema.field(name).type)
        if name in BY_NAME and BY_NAME[name].always and column.null_count:
            row = int(np.argmin(column.is_valid().to_numpy()))
            yield Departure("empty-cell", f"{column.null_count} empty cells of {name}", table.place(row))
        if kind in ("double", "float"):
            table.numbers(name, tally)
    for entry in tally.result():
        yield Departure("non-finite", f"{entry.count} {entry.reason}", entry.where)


def _rows(table: Table) -> Iterator[Departure]:
    """Stamps that do not increase, runs in pieces, poses and twists in part; of columns that are sound."""
    tally = Tally()
    run, t = table.codes("run")[0], table.numbers("t", tally)
    begins = np.flatnonzero(np.diff(run, prepend=-1))
    if len(begins) > len(np.unique(run)):
        yield Departure("run-in-pieces", "rows of a run are not together", table.place(int(begins[-1])))
    back = np.flatnonzero((np.diff(t) <= 0.0) & (np.diff(run) == 0))
    if len(back):
        yield Departure("stamp-order", f"{len(back)} stamps do not increase", table.place(int(back[0]) + 1))
    fresh = table.numbers("pose_new", tally)
    yield from _first(table, (fresh != 0.0) & (fresh != 1.0), "pose-new", "pose_new is neither 0 nor 1")
    there = {
        name: np.isfinite(table.numbers(name, tally))
        for name in table.names
        if name in BY_NAME and BY_NAME[name].shared and BY_NAME[name].type == "number"
    }
    whole = there["x"] & there["y"] & there["yaw"]
    yield from _first(table, (fresh == 1.0) & ~whole, "pose-part", "a measured pose lacks x, y or yaw")
    for first, second in (pair for pair in _TWISTS if pair[0] in there and pair[1] in there):
        apart = there[first] != there[second]
        yield from _first(table, apart, "twist-part", f"one of {first} and {second} is empty")
    for name in (name for name in ("std_xy", "std_yaw") if name in there):
        wrong = table.numbers(name, tally) < 0.0
        yield from _first(table, wrong, "negative-std", f"{name} is negative")


def _first(table: Table, wrong: np.ndarray, kind: str, what: str) -> Iterator[Departure]:
    if wrong.any():
        yield Departure(kind, f"{what}, in {int(wrong.sum())} rows", table.place(int(np.argmax(wrong))))


def _beside(path: Path, table: Table, log: Log | None) -> Iterator[Departure]:
    """What is wrong with the schema file and the card."""
    schema = schema_path(path)
    try:
        content = json.loads(read_whole(schema, most=_MOST_SCHEMA, error=LogError))
        if content != schema_of(table):
            yield Departure("schema", "the schema file is not that of this table's columns", str(schema))
    except LogError as problem:
        yield Departure("schema", f"no schema file: {problem.what}", str(schema))
    except (ValueError, RecursionError):
        yield Departure("schema", "the schema file is not JSON", str(schema))
    try:
        card = read_card(card_path(path))
    except LogError as problem:
        yield Departure("card", problem.what, problem.where)
        return
    yield from _card(card, path, table, log)


def _card(card: DataCard, path: Path, table: Table, log: Log | None) -> Iterator[Departure]:
    place = str(card_path(path))
    if card.file.sha256 != sha256_of(path):
        yield Departure("card", "the card is of another table: the hashes differ", place)
    if card.file.rows != len(table):
        yield Departure("card", f"the card says {card.file.rows} rows, the table has {len(table)}", place)
    for name in ("licence", "vehicle", "sensors"):
        if getattr(card, name).strip().lower() == NOT_STATED:
            yield Departure("card", f"the {name} is {NOT_STATED}", place)
    if not card.anonymised or log is None:
        return
    for run in log.runs:
        for frame in np.unique(run.poses.frame).tolist():
            k = int(np.argmax(run.poses.frame == frame))
            if max(abs(float(c[k])) for c in (run.poses.x, run.poses.y, run.poses.yaw)) > _ORIGIN:
                what = "the card says anonymised, but a frame does not begin at the origin"
                yield Departure("not-anonymised", what, run.place(float(run.poses.t[k])))
    if log.runs and log.runs[0].span[0] > _ORIGIN:
        yield Departure("not-anonymised", "the stamps do not count from the start of the log", path.name)
