# SPDX-License-Identifier: Apache-2.0
"""Reads and writes labels of the surface, as a terrain classifier says them: windows by run and time."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError
from slipwise.files import write_text_whole
from slipwise.logs.left_out import Tally
from slipwise.logs.open_log import readable
from slipwise.logs.table import Table, read_table
from slipwise.terrain.classifier import UNKNOWN, Answer
from slipwise.terrain.windows import Windows

Floats = NDArray[np.float64]

ENDINGS = (".csv", ".csv.gz", ".parquet")
_NEEDED = ("run", "t_start", "t_end", "label")
_ADVICE = "write it by `slipwise terrain classify`, or as run,t_start,t_end,label,p_<class>...,p_unknown"


@dataclass(frozen=True)
class Window:
    """What was said of one window."""

    start: float  # s
    end: float  # s; the answer comes only then
    answer: _core.TerrainAnswer


def is_label_file(text: str) -> bool:
    """Return whether a text names such a file, not a surface."""
    return text.lower().endswith(ENDINGS)


def read_labels(paths: Sequence[Path]) -> dict[str, tuple[Window, ...]]:
    """Return the windows of each run in the order of their ends.

    Columns `p_<class>` are probabilities of the classes; without them the label is taken as certain. Rows
    without numbers say nothing.

    Args:
        paths: tables with the columns `run,t_start,t_end,label`, and `p_<class>...`, `p_unknown`.

    Raises:
        LogError: a file cannot be read, lacks a column, or holds what is no probability.
    """
    runs: dict[str, list[Window]] = {}
    for path in paths:
        table = _table(path)
        codes, names = table.codes("run")
        tally = Tally()
        start, end = table.numbers("t_start", tally), table.numbers("t_end", tally)
        for row, answer in _answers(table, tally):
            if np.isfinite([start[row], end[row]]).all() and end[row] >= start[row]:
                window = Window(float(start[row]), float(end[row]), answer)
                runs.setdefault(names[codes[row]], []).append(window)
    if not runs:
        raise LogError("no window has a label", where=str(paths[0]), advice=_ADVICE)
    return {run: tuple(sorted(windows, key=lambda each: each.end)) for run, windows in runs.items()}


def _table(path: Path) -> Table:
    file, bag = readable(path)
    if bag:
        raise LogError("a bag, not a table of labels", where=str(path), advice=_ADVICE)
    table = read_table(file, numeric=("t_start", "t_end"), text=("run", "label"), columns={}, tally=Tally())
    missing = [name for name in _NEEDED if name not in table.names]
    if missing:
        raise LogError(f"no column {missing[0]!r} in a table of labels", where=str(path), advice=_ADVICE)
    return table


def _answers(table: Table, tally: Tally) -> list[tuple[int, _core.TerrainAnswer]]:
    """Return the rows that say something, each with what it says."""
    known = "p_" + UNKNOWN
    columns = [name for name in table.names if name.startswith("p_") and name != known]
    if not columns:
        return _certain(table)
    classes = [name.removeprefix("p_") for name in columns]
    odds = np.column_stack([table.numbers(name, tally) for name in columns])
    unknown = table.numbers(known, tally) if known in table.names else np.zeros(len(table))
    made = []
    for row in np.flatnonzero(np.isfinite(odds).all(axis=1)).tolist():
        unknown_share = float(unknown[row]) if np.isfinite(unknown[row]) else 0.0
        try:
            made.append((row, _core.TerrainAnswer(classes, odds[row], unknown_share)))
        except ValueError as problem:
            raise LogError(str(problem), where=table.place(row), advice=_ADVICE) from problem
    return made


def _certain(table: Table) -> list[tuple[int, _core.TerrainAnswer]]:
    codes, names = table.codes("label")
    classes = [name for name in names if name not in ("", UNKNOWN)]
    if not classes:
        return []
    made = []
    for row, name in enumerate(names[code] for code in codes.tolist()):
        if name:
            odds = np.array([float(name == each) for each in classes])
            unknown = name == UNKNOWN
            even = np.full(len(classes), 1.0 / len(classes))
            made.append((row, _core.TerrainAnswer(classes, even if unknown else odds, float(unknown))))
    return made


def write_labels(path: Path, windows: Windows, answer: Answer, labels: NDArray[np.object_]) -> Path:
    """Write `run,t_start,t_end,label,p_<surface>...,p_unknown`, a row for each window that has a label.

    The probabilities of the surfaces add up to 1: they are those if the surface is one that was trained.

    Args:
        path: the CSV file.
        windows: the windows, [N].
        answer: what the classifier says about them.
        labels: the surface, or "unknown", of each, [N]; empty where no sensor said anything.

    Raises:
        OutputError: the file cannot be written.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["run", "t_start", "t_end", "label", *(f"p_{name}" for name in answer.surfaces), "p_unknown"]
    )
    for k in np.flatnonzero(labels != ""):
        odds = [*answer.probability[k].tolist(), float(answer.unknown[k])]
        numbers = ["" if math.isnan(value) else f"{value:.4f}" for value in odds]
        rows.writerow(
            [windows.run[k], f"{windows.start[k]:.3f}", f"{windows.end[k]:.3f}", labels[k], *numbers]
        )
    write_text_whole(path, text.getvalue())
    return path
