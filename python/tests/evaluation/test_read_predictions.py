# SPDX-License-Identifier: Apache-2.0
"""A prediction file is read whoever wrote it; one that is wrong is an error that names the column or line."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log

from slipwise.calibration.prepared_run import WindowSet
from slipwise.calibration.settings import Settings
from slipwise.errors import LogError
from slipwise.evaluation import EvaluationOptions, evaluate, write_predictions
from slipwise.evaluation.evaluate import contest_of
from slipwise.evaluation.read_predictions import predictions_on, read_predictions

Rows = list[dict[str, str]]
LOG = simulated_log(Drive(seconds=30.0))


@pytest.fixture(scope="module")
def _rows(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    path = tmp_path_factory.mktemp("rows") / "p.csv"
    options = EvaluationOptions(horizons=(2.0,), methods=("none",))
    write_predictions(path, evaluate(LOG, options=options))
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def targets() -> WindowSet:
    return contest_of(LOG, "command", Settings(), EvaluationOptions((2.0,)))[0].targets[0]


@pytest.fixture
def rows(_rows: Rows) -> Rows:
    return [dict(row) for row in _rows]


def written(path: Path, rows: Rows) -> Path:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return path


def on_the_log(path: Path, targets: WindowSet) -> None:
    predictions_on(read_predictions(path), targets, [run.name for run in LOG.runs])


def without(*prefixes: str) -> Callable[[Rows], Rows]:
    return lambda rows: [{k: v for k, v in row.items() if not k.startswith(prefixes)} for row in rows]


def cell(row: int, name: str, value: str) -> Callable[[Rows], Rows]:
    return lambda rows: [{**each, name: value} if k == row else each for k, each in enumerate(rows)]


WRONG: dict[str, tuple[Callable[[Rows], Rows], str]] = {
    "no column": (without("dyaw"), "missing columns: dyaw"),
    "half a covariance": (without("cov_tt"), "missing columns: cov_tt"),
    "text": (cell(2, "dx", "far"), "not a tidy table: In column dx"),
    "empty": (cell(2, "dx", ""), "an empty cell of dx .p.csv, line 4"),
    "nan": (cell(2, "dx", "nan"), "1 x cells of dx that are not finite"),
    "covariance": (cell(2, "cov_xx", "-1"), "the covariance is not positive definite .p.csv, line 4"),
    "dof": (cell(2, "dof", "1"), "dof is below 2.5 .p.csv, line 4"),
    "other run": (cell(2, "run", "other"), "1 predictions over 2 s are of no window .*line 4, run other"),
    "other time": (cell(2, "t_start", "0.123"), "1 predictions over 2 s are of no window"),
    "other end": (cell(2, "t_end", "3.5"), "1 predictions over 2 s are of no window"),
    "twice": (lambda rows: [*rows, rows[-1]], "none predicts a window twice .p.csv, line 17"),
    "left out": (lambda rows: rows[:-2], "none has no prediction of 2 of 8 scored windows over 2 s"),
    "sequence": (lambda rows: [{**row, "log": "0"} for row in rows], "the file of a sequence of logs"),
}


def test_a_wrong_file_is_a_clear_error(
    rows: Rows, targets: WindowSet, tmp_path: Path, subtests: pytest.Subtests
) -> None:
    for name, (change, message) in WRONG.items():
        with subtests.test(name=name), pytest.raises(LogError, match=message):
            on_the_log(written(tmp_path / "p.csv", change(rows)), targets)


def test_what_is_no_such_table_is_a_clear_error(tmp_path: Path, subtests: pytest.Subtests) -> None:
    for content in [b"", b"\0\1\2", b"run;method\n1;2\n", b"run,method\n", b"\x1f\x8b\x08", b"\xff\xfe,\n"]:
        with subtests.test(content=content):
            path = tmp_path / "p.csv"
            path.write_bytes(content)
            with pytest.raises(LogError):
                read_predictions(path)
            with pytest.raises(LogError, match="no such prediction file"):
                read_predictions(tmp_path)


def test_the_first_half_may_be_left_out_and_rows_be_in_any_order(
    rows: Rows, targets: WindowSet, tmp_path: Path
) -> None:
    on_the_log(written(tmp_path / "p.csv", rows[:6:-1]), targets)


def test_a_file_without_covariances_is_read(rows: Rows, tmp_path: Path) -> None:
    read = read_predictions(written(tmp_path / "p.csv", without("cov_", "dof", "learned")(rows)))
    assert not read.has_covariance
    assert (read.methods, read.horizons) == (("none",), (2.0,))
