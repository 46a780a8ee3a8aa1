# SPDX-License-Identifier: Apache-2.0
"""Reads tables of what an IMU and motor drivers measured, and joins them by run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.open_log import readable
from slipwise.logs.table import Table, read_table

Floats = NDArray[np.float64]

IMU = ("wx", "wy", "wz", "ax", "ay", "az")  # rad/s, m/s^2
DRIVE = ("curL", "curR", "velL", "velR")  # A, m/s
_ADVICE = f"a table needs `time` and {' '.join(IMU)}, or {' '.join(DRIVE)}, or both"


@dataclass(frozen=True)
class Stream:
    """What one kind of sensor measured in one run."""

    t: Floats  # [N] s, increasing
    values: Floats  # [N, D]


@dataclass(frozen=True)
class Recording:
    """One run: the streams that it has, and the labels where there are some."""

    run: str
    imu: Stream | None
    drive: Stream | None
    label_t: Floats  # [L] s, increasing
    labels: NDArray[np.object_]  # [L] names of surfaces

    @property
    def span(self) -> tuple[float, float]:
        """Return the first and the last time [s] of any stream."""
        streams = [stream.t for stream in (self.imu, self.drive) if stream is not None]
        return min(float(t[0]) for t in streams), max(float(t[-1]) for t in streams)

    def label(self, start: float, end: float) -> str:
        """Return the surface from `start` to `end` [s]; empty where there is none, or more than one."""
        inside = set(self.labels[(self.label_t >= start) & (self.label_t < end)])
        return str(inside.pop()) if len(inside) == 1 else ""


def read_recordings(paths: Sequence[Path]) -> tuple[list[Recording], list[str]]:
    """Read tables; rows of one run may be spread over several files, with times of one clock.

    Args:
        paths: CSV, CSV.gz or Parquet files with `time` (or `t`), the columns of `IMU`, of `DRIVE` or both,
            `run` where there is more than one, and `terrain` where the surface is known.

    Returns:
        The runs, by name, and notes on what was left out.

    Raises:
        LogError: a file cannot be read, or has none of the columns; a run has one stream in two files.
    """
    streams: dict[tuple[str, str], Stream] = {}
    labels: dict[str, tuple[Floats, NDArray[np.object_]]] = {}
    tally = Tally()
    for path in paths:
        table = _table(path, tally)
        for run, rows in _rows_of_runs(table).items():
            found = _streams(table, run, rows, tally)
            twice = [kind for kind in found if (run, kind) in streams]
            if twice:
                raise LogError(
                    f"run {run} has columns of the {twice[0]} in two files",
                    where=str(path),
                    advice="name the runs differently in the column `run`",
                )
            streams |= {(run, kind): stream for kind, stream in found.items()}
            if "terrain" in table.names:
                labels[run] = _labels(table, rows, tally)
    runs = sorted({run for run, _ in streams})
    if not runs:
        raise LogError("no run has a measurement", where=str(paths[0]), advice=_ADVICE)
    nothing = np.empty(0), np.empty(0, dtype=object)
    made = [
        Recording(run, streams.get((run, "imu")), streams.get((run, "drive")), *labels.get(run, nothing))
        for run in runs
    ]
    return made, [f"left out: {entry.count} {entry.reason} ({entry.where})" for entry in tally.result()]


def _table(path: Path, tally: Tally) -> Table:
    file, bag = readable(path)
    if bag:
        raise LogError("a bag, not a table", where=str(path), advice="write its IMU and currents as CSV")
    numeric, text = ("time", "t", *IMU, *DRIVE), ("run", "terrain")
    table = read_table(file, numeric=numeric, text=text, columns={}, tally=tally)
    if _time_name(table) not in table.names or not any(_has(table, names) for names in (IMU, DRIVE)):
        raise LogError("neither IMU nor motor currents", where=str(path), advice=_ADVICE)
    return table


def _time_name(table: Table) -> str:
    return "time" if "time" in table.names else "t"


def _has(table: Table, names: Sequence[str]) -> bool:
    return all(name in table.names for name in names)


def _rows_of_runs(table: Table) -> dict[str, NDArray[np.int64]]:
    if "run" not in table.names:
        name = table.path.name.split(".")[0]
        return {name: np.arange(len(table))}
    codes, names = table.codes("run")
    return {name: np.flatnonzero(codes == code) for code, name in enumerate(names) if (codes == code).any()}


def _streams(table: Table, run: str, rows: NDArray[np.int64], tally: Tally) -> dict[str, Stream]:
    found = {}
    for kind, names in (("imu", IMU), ("drive", DRIVE)):
        if not _has(table, names):
            continue
        t = table.numbers(_time_name(table), tally)[rows]
        values = np.stack([table.numbers(name, tally)[rows] for name in names], axis=1)
        whole = np.isfinite(t) & np.isfinite(values).all(axis=1)
        t, values = t[whole], values[whole]
        later = np.concatenate([[True], t[1:] > np.maximum.accumulate(t)[:-1]]) if len(t) else whole[:0]
        place = f"{table.path.name}, run {run}"
        tally.add("time-back", "rows whose time does not go on", count=int((~later).sum()), where=place)
        if later.sum() >= 2:
            found[kind] = Stream(t[later], values[later])
    return found


def _labels(table: Table, rows: NDArray[np.int64], tally: Tally) -> tuple[Floats, NDArray[np.object_]]:
    codes, names = table.codes("terrain")
    t = table.numbers(_time_name(table), tally)[rows]
    values = np.array(names, dtype=object)[codes[rows]]
    named = np.isfinite(t) & (values != "")
    return t[named], values[named]
