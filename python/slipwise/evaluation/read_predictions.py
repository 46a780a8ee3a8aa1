# SPDX-License-Identifier: Apache-2.0
"""Reads a prediction file, whoever wrote it, and holds its rows against the windows of a log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.statistics import held_out_half
from slipwise.errors import LogError
from slipwise.evaluation.prediction_file import COLUMNS, LOG
from slipwise.logs.left_out import Tally
from slipwise.logs.table import Table, read_csv
from slipwise.student import LEAST_DOF, MOST_DOF

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TEXT = ("run", "method")
POSE = ("dx", "dy", "dyaw")
COVARIANCE = tuple(name for name in COLUMNS if name.startswith("cov_"))
REQUIRED = (*TEXT, "t_start", "t_end", "horizon", *POSE)
MOST_METHODS = 1000


@dataclass(frozen=True, eq=False)
class PredictionRows:
    """The rows of a prediction file, [N] each."""

    table: Table  # to say where a row is
    run: tuple[str, ...]
    method: tuple[str, ...]
    numbers: dict[str, Floats] = field(repr=False)  # by column; those that the file has

    def __len__(self) -> int:
        return len(self.run)

    @property
    def methods(self) -> tuple[str, ...]:
        """The methods in the order in which they appear."""
        return tuple(dict.fromkeys(self.method))

    @property
    def horizons(self) -> tuple[float, ...]:
        """All horizons, the shortest first [s]."""
        return tuple(np.unique(self.numbers["horizon"]).tolist())

    @property
    def has_covariance(self) -> bool:
        """Whether each prediction says how sure it is."""
        return COVARIANCE[0] in self.numbers


def read_predictions(path: Path) -> PredictionRows:
    """Read a prediction file: the columns of `REQUIRED`, and of the others those that are there.

    The six columns of a covariance come together or not at all; `dof` and `learned_until` may be missing.

    Raises:
        LogError: it is no such file; the error names the column or the line.
    """
    if not path.is_file():
        raise LogError("no such prediction file", where=str(path), advice="check the path")
    tally = Tally()
    numeric = [name for name in COLUMNS if name not in TEXT]
    table = read_csv(path, numeric=numeric, text=TEXT, columns={}, tally=tally)
    _require(table)
    found = [name for name in numeric if name in table.names]
    numbers = {name: table.numbers(name, tally) for name in found}
    for entry in tally.result():
        raise LogError(f"{entry.count} x {entry.reason}", where=entry.where, advice="write the file again")
    for name, values in numbers.items():
        if not np.isfinite(values).all():
            at = table.place(int(np.argmin(np.isfinite(values))))
            raise LogError(f"an empty cell of {name}", where=at, advice="every prediction needs it")
    run, method = (_names(table, name) for name in TEXT)
    rows = PredictionRows(table, run, method, numbers)
    if len(rows.methods) > MOST_METHODS:
        raise LogError("too many methods", where=str(path), advice=f"at most {MOST_METHODS} are scored")
    _refuse_no_covariance(rows)
    return rows


def predictions_on(rows: PredictionRows, targets: WindowSet, runs: Sequence[str]) -> tuple[Predictions, ...]:
    """Return what each method of the file predicts of the windows of one horizon.

    What it does not say of the first half, which is not scored, is NaN.

    Args:
        rows: the file.
        targets: the windows of the horizon.
        runs: names of the log's runs.

    Raises:
        LogError: a row is of no window, a window is there twice, or one that is scored is missing.
    """
    at = np.flatnonzero(np.isclose(rows.numbers["horizon"], targets.length, rtol=0.0, atol=_core.SAME_STAMP))
    window = _windows_of(rows, at, targets, runs)
    index = np.array([drive.index for drive in targets.drive], dtype=np.int64)[targets.position]
    methods = np.array(rows.method, dtype=object)
    return tuple(
        _predictions(name, rows, (at[methods[at] == name], window[methods[at] == name]), targets, index)
        for name in rows.methods
    )


def _require(table: Table) -> None:
    if LOG in table.names:
        raise LogError(
            "this is the file of a sequence of logs, with a column 'log'",
            where=str(table.path),
            advice="write the rows of each log into a file of its own, without that column",
        )
    missing = [name for name in REQUIRED if name not in table.names]
    part = [name for name in COVARIANCE if name in table.names]
    if part:
        missing += [name for name in COVARIANCE if name not in table.names]
    if missing:
        raise LogError(
            f"missing columns: {', '.join(missing)}",
            where=str(table.path),
            advice=f"a prediction file has {', '.join(REQUIRED)}, and all of {', '.join(COVARIANCE)} or none",
        )
    if len(table) == 0:
        raise LogError("the prediction file has no rows", where=str(table.path), advice="predict something")


def _names(table: Table, name: str) -> tuple[str, ...]:
    codes, names = table.codes(name)
    return tuple(names[code] for code in codes.tolist())


def _refuse_no_covariance(rows: PredictionRows) -> None:
    if not rows.has_covariance:
        return
    lowest = np.linalg.eigvalsh(_covariances(rows, np.arange(len(rows)))).min(axis=1)
    if (lowest <= 0.0).any():
        place = rows.table.place(int(np.argmax(lowest <= 0.0)))
        raise LogError(
            "the covariance is not positive definite",
            where=place,
            advice="leave out all cov_ columns, or mend it",
        )
    dof = rows.numbers.get("dof")
    if dof is not None and (dof < LEAST_DOF).any():
        place = rows.table.place(int(np.argmax(dof < LEAST_DOF)))
        raise LogError(
            f"dof is below {LEAST_DOF:g}", where=place, advice="a Student t needs more to have a covariance"
        )


def _covariances(rows: PredictionRows, at: Ints) -> Floats:
    full = np.empty((len(at), 3, 3))
    for name, (i, j) in zip(COVARIANCE, ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)), strict=True):
        full[:, i, j] = full[:, j, i] = rows.numbers[name][at]
    return full


def _windows_of(rows: PredictionRows, at: Ints, targets: WindowSet, runs: Sequence[str]) -> Ints:
    """Return the window that each of the rows is of, [len(at)]."""
    place_of = {runs[drive.index]: k for k, drive in enumerate(targets.drive)}
    found = np.full(len(at), -1, dtype=np.int64)
    names = np.array(rows.run, dtype=object)[at]
    for name, position in place_of.items():
        mine, own = np.flatnonzero(names == name), np.flatnonzero(targets.position == position)
        if len(mine) == 0 or len(own) == 0:
            continue
        start = rows.numbers["t_start"][at[mine]]
        nearest = own[_nearest(targets.start[own], start)]
        fits = np.abs(targets.start[nearest] - start) <= _core.SAME_STAMP
        fits &= np.abs(targets.end[nearest] - rows.numbers["t_end"][at[mine]]) <= _core.SAME_STAMP
        found[mine[fits]] = nearest[fits]
    if (found < 0).any():
        row = int(at[np.argmax(found < 0)])
        raise LogError(
            f"{int((found < 0).sum())} predictions over {targets.length:g} s are of no window of the log",
            where=f"{rows.table.place(row)}, run {rows.run[row]}, t_start {rows.numbers['t_start'][row]:g}",
            advice="the windows are those of `slipwise evaluate LOG --methods none --predictions FILE`",
        )
    return found


def _nearest(sorted_values: Floats, values: Floats) -> Ints:
    """Index of the nearest of increasing values, [len(values)]."""
    if len(sorted_values) == 1:
        return np.zeros(len(values), dtype=np.int64)
    after = np.clip(np.searchsorted(sorted_values, values), 1, len(sorted_values) - 1)
    closer = values - sorted_values[after - 1] < sorted_values[after] - values
    return np.asarray(after - closer, dtype=np.int64)


def _predictions(
    name: str, rows: PredictionRows, found: tuple[Ints, Ints], targets: WindowSet, run: Ints
) -> Predictions:
    at, window = found
    size = len(targets)
    _refuse_gaps(name, rows, found, targets)
    pose = np.full((size, 3), np.nan)
    pose[window] = np.column_stack([rows.numbers[column][at] for column in POSE])
    covariance = np.full((size, 3, 3), np.nan)
    dof, until = np.full(size, MOST_DOF), targets.start.copy()
    if rows.has_covariance:
        covariance[window] = _covariances(rows, at)
    if "dof" in rows.numbers:
        dof[window] = np.minimum(rows.numbers["dof"][at], MOST_DOF)
    if "learned_until" in rows.numbers:
        until[window] = rows.numbers["learned_until"][at]
    return Predictions(
        method=name,
        horizon=targets.length,
        run=run,
        t_start=targets.start,
        t_end=targets.end,
        pose=pose,
        covariance=covariance,
        inflation=np.ones(size),
        dof=dof,
        nominal_nis=np.full(size, np.nan),
        structure=np.zeros(size, dtype=np.int64),
        measured=targets.measured,
        learned_until=until,
        in_sample=np.full((size, 2), np.nan),
    )


def _refuse_gaps(name: str, rows: PredictionRows, found: tuple[Ints, Ints], targets: WindowSet) -> None:
    at, window = found
    counts = np.bincount(window, minlength=len(targets))
    if (counts > 1).any():
        twice = int(np.argmax(counts > 1))
        row = int(at[np.flatnonzero(window == twice)[1]])
        raise LogError(
            f"{name} predicts a window twice", where=rows.table.place(row), advice="one row for each window"
        )
    missing = np.flatnonzero(counts[held_out_half(len(targets))] == 0)
    if len(missing):
        scored = held_out_half(len(targets))
        first = scored.start + int(missing[0])
        raise LogError(
            f"{name} has no prediction of {len(missing)} of {scored.stop - scored.start} scored windows over "
            f"{targets.length:g} s",
            where=f"{rows.table.path}, the first from t_start {targets.start[first]:g} s",
            advice="predict every window of the second half: what is hard may not be left out",
        )
