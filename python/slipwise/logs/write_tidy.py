# SPDX-License-Identifier: Apache-2.0
"""Writes a log as a tidy table that `open_log` reads back equal."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.files import write_whole
from slipwise.logs.fixes import fix_words
from slipwise.logs.log import OPTIONAL_POSE_COLUMNS, Floats, Ints, Log, Poses, Run

if TYPE_CHECKING:
    import pyarrow as pa


def write_csv(log: Log, path: Path, *, compressed: bool = False) -> None:
    """Write the log as CSV, compressed with gzip if asked for.

    Raises:
        OutputError: the file cannot be written.
        LogError: the log holds nothing.
    """
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    table = tidy_table(log)

    def write(temporary: Path) -> None:
        with pa.OSFile(str(temporary), "wb") as file:
            if compressed:
                with pa.CompressedOutputStream(file, "gzip") as stream:
                    arrow_csv.write_csv(table, stream)
            else:
                arrow_csv.write_csv(table, file)

    write_whole(path, write)


def write_parquet(log: Log, path: Path) -> None:
    """Write the log as Parquet.

    Raises:
        OutputError: the file cannot be written.
        LogError: the log holds nothing.
    """
    import pyarrow.parquet as parquet

    table = tidy_table(log)
    write_whole(path, lambda temporary: parquet.write_table(table, temporary))


def tidy_table(log: Log) -> pa.Table:
    """Return the log as one table with the columns of a tidy log; empty cells where a row has no such number.

    Raises:
        LogError: the log holds nothing.
    """
    import pyarrow as pa

    parts = [_columns(run) for run in log.runs]
    count = sum(len(part["t"]) for part in parts)
    if count == 0:
        raise LogError("there is nothing to write", advice="the log has no sample")
    names = list(dict.fromkeys(name for part in parts for name in part))
    run_names = [run.name for run in log.runs]
    codes = np.repeat(np.arange(len(parts), dtype=np.int32), [len(part["t"]) for part in parts])
    columns: dict[str, Any] = {"run": pa.DictionaryArray.from_arrays(codes, run_names).cast(pa.string())}
    for name in names:
        columns[name] = _joined(name, parts)
    return pa.table(columns)


def _columns(run: Run) -> dict[str, NDArray[Any]]:
    """Return the columns of one run, one row for every stamp; further sources have rows of their own."""
    series = (run.commands, run.wheels, run.forces, run.poses)
    extra_t = np.asarray(run.extra.get("t", np.empty(0)), dtype=np.float64)
    stamps = [each.t for each in series if each is not None] + [extra_t[np.isfinite(extra_t)]]
    rows = _Rows(np.unique(np.concatenate(stamps)), [other.t for other in run.others.values()])
    _put_inputs(rows, run)
    if run.forces is not None:
        at = rows.of(run.forces.t)
        rows.put("force_x", at, run.forces.x)
        rows.put("force_y", at, run.forces.y)
    rows.columns["pose_new"] = np.zeros(len(rows.t), np.int8)
    _put_poses(rows, rows.of(run.poses.t), run.poses, run.source if run.others else "")
    for number, (name, other) in enumerate(run.others.items()):
        _put_poses(rows, rows.own[number], other, name)
    kept = np.isfinite(extra_t)
    taken = set(rows.columns)
    for name, values in run.extra.items():
        if name not in taken:
            rows.put(name, rows.of(extra_t[kept][::-1]), np.asarray(values)[kept][::-1])
    return rows.columns


class _Rows:
    """Rows in the order of their stamps.

    Args:
        shared: stamps [s] of rows that hold all that was measured then, increasing.
        own: stamps of the rows that each of the further sources has for itself.
    """

    def __init__(self, shared: Floats, own: Sequence[Floats]) -> None:
        every = np.concatenate([shared, *own])
        order = np.argsort(every, kind="stable")
        place = np.empty(len(every), np.int64)
        place[order] = np.arange(len(every))
        edges = np.cumsum([len(shared), *map(len, own)])
        self._shared, self._place = shared, place[: len(shared)]
        self.own = [place[start:stop] for start, stop in itertools.pairwise(edges)]
        self.t: Floats = every[order]
        self.columns: dict[str, NDArray[Any]] = {"t": self.t}

    def of(self, t: Floats) -> Ints:
        """Return the shared rows of stamps."""
        return self._place[np.searchsorted(self._shared, t)]

    def put(self, name: str, rows: Ints, values: NDArray[Any]) -> None:
        """Set cells of a column, which is empty elsewhere."""
        text = values.dtype.kind in "OUS"
        if name not in self.columns:
            empty = np.full(len(self.t), None, dtype=object) if text else np.full(len(self.t), np.nan)
            self.columns[name] = empty
        self.columns[name][rows] = values


def _put_inputs(rows: _Rows, run: Run) -> None:
    car = None if run.commands is None else run.commands.car
    if run.commands is not None and car is not None:  # its speeds are what its curves make of these
        at = rows.of(run.commands.t)
        rows.put("throttle", at, car.throttle)
        rows.put("steering", at, car.steering)
    if run.commands is not None and run.commands.ended is not None:
        rows.put("cmd_ended", rows.of(run.commands.t), run.commands.ended.astype(np.float64))
    for prefix, inputs in (("cmd", None if car is not None else run.commands), ("odo", run.wheels)):
        if inputs is not None:
            at = rows.of(inputs.t)
            rows.put(f"{prefix}_v", at, inputs.v)
            if inputs.vy.any():
                rows.put(f"{prefix}_vy", at, inputs.vy)
            rows.put(f"{prefix}_omega", at, inputs.omega)


def _put_poses(rows: _Rows, at: Ints, poses: Poses, source: str) -> None:
    for name in ("x", "y", *(() if poses.course else ("yaw",)), *OPTIONAL_POSE_COLUMNS):
        values = getattr(poses, name)
        if values is not None:
            rows.put(name, at, fix_words(values) if name == "fix" else values)
    rows.columns["pose_new"][at] = 1
    if poses.frame.any():
        rows.put("frame", at, poses.frame.astype(np.float64))
    if source:
        rows.put("source", at, np.full(len(poses), source, dtype=object))


def _joined(name: str, parts: list[dict[str, NDArray[Any]]]) -> Any:
    """Put one column of all runs together as Arrow; NaN becomes an empty cell."""
    import pyarrow as pa

    chunks = []
    text = any(name in part and part[name].dtype == object for part in parts)
    for part in parts:
        values = part.get(name)
        if text:
            blank = [None] * len(part["t"])
            chunks.append(
                pa.array(
                    blank if values is None else [v if v is None else str(v) for v in values], pa.string()
                )
            )
        elif values is None:
            chunks.append(pa.nulls(len(part["t"]), pa.float64()))
        else:
            chunks.append(pa.array(values.astype(np.float64), mask=np.isnan(values.astype(np.float64))))
    column = pa.chunked_array(chunks)
    return column.cast(pa.int64()) if name in ("cmd_ended", "frame", "pose_new") else column
