# SPDX-License-Identifier: Apache-2.0
"""Writes a log as a tidy table that `open_log` reads back equal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.files import write_whole
from slipwise.logs.fixes import fix_words
from slipwise.logs.log import OPTIONAL_POSE_COLUMNS, Floats, Log, Run

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
    """Return the columns of one run, one row for every stamp that occurs."""
    if run.others:
        raise LogError(
            "a table is written of one source of poses alone",
            advice="read the log with --pose-topic or --poses",
        )
    stamps = [series.t for series in (run.commands, run.wheels, run.poses) if series is not None]
    extra_t = np.asarray(run.extra.get("t", np.empty(0)), dtype=np.float64)
    t = np.unique(np.concatenate([*stamps, extra_t[np.isfinite(extra_t)]]))
    columns: dict[str, NDArray[Any]] = {"t": t}

    def put(name: str, at: Floats, values: NDArray[Any]) -> None:
        text = values.dtype.kind in "OUS"
        column = np.full(len(t), None, dtype=object) if text else np.full(len(t), np.nan)
        column[np.searchsorted(t, at)] = values
        columns[name] = column

    for prefix, inputs in (("cmd", run.commands), ("odo", run.wheels)):
        if inputs is not None:
            put(f"{prefix}_v", inputs.t, inputs.v)
            if inputs.vy.any():
                put(f"{prefix}_vy", inputs.t, inputs.vy)
            put(f"{prefix}_omega", inputs.t, inputs.omega)
    poses = run.poses
    for name in ("x", "y", *(() if poses.course else ("yaw",)), *OPTIONAL_POSE_COLUMNS):
        values = getattr(poses, name)
        if values is not None:
            put(name, poses.t, fix_words(values) if name == "fix" else values)
    fresh = np.zeros(len(t), np.int8)
    fresh[np.searchsorted(t, poses.t)] = 1
    columns["pose_new"] = fresh
    if poses.frame.any():
        put("frame", poses.t, poses.frame.astype(np.float64))
    kept = np.isfinite(extra_t)
    for name, values in run.extra.items():
        if name not in columns:
            put(name, extra_t[kept][::-1], np.asarray(values)[kept][::-1])
    return columns


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
    return column.cast(pa.int64()) if name in ("frame", "pose_new") else column
