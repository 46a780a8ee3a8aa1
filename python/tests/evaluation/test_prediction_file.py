# SPDX-License-Identifier: Apache-2.0
"""The prediction file has the columns that everyone reads, and rows that can be scored on their own."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log, simulated_run

from slipwise.errors import OutputError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate, write_predictions
from slipwise.logs import Log

HEADER = [
    *("run", "method", "t_start", "t_end", "horizon", "dx", "dy", "dyaw"),
    *("cov_xx", "cov_xy", "cov_xt", "cov_yy", "cov_yt", "cov_tt", "learned_until", "dof"),
]


@pytest.fixture(scope="module")
def evaluation() -> Evaluation:
    runs = (simulated_run(Drive(name="a, b", seconds=30.0)), simulated_run(Drive(name='c "d"', seconds=30.0)))
    return evaluate(Log(runs=runs), options=EvaluationOptions(methods=("none", "edd-2", "batch")))


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_columns_are_exactly_those_of_the_format(evaluation: Evaluation, tmp_path: Path) -> None:
    write_predictions(tmp_path / "p.csv", evaluation)
    with (tmp_path / "p.csv").open(encoding="utf-8", newline="") as file:
        assert next(csv.reader(file)) == HEADER


def test_every_number_is_read_back_exactly(evaluation: Evaluation, tmp_path: Path) -> None:
    write_predictions(tmp_path / "p.csv", evaluation)
    rows = rows_of(tmp_path / "p.csv")
    causal = [p for p in evaluation.predictions if p.method != "batch"]
    assert len(rows) == sum(len(p) for p in causal)
    at = 0
    for p in causal:
        for i in range(len(p)):
            row, at = rows[at], at + 1
            assert (row["run"], row["method"]) == (evaluation.runs[p.run[i]], p.method)
            numbers = [p.t_start[i], p.t_end[i], p.horizon, *p.pose[i]]
            assert [float(row[name]) for name in HEADER[2:8]] == numbers
            upper = p.covariance[i][np.triu_indices(3)].tolist()
            assert [float(row[name]) for name in HEADER[8:14]] == upper
            assert float(row["dof"]) == p.dof[i]
            assert float(row["learned_until"]) == p.learned_until[i] <= p.t_start[i]


def test_methods_that_saw_the_windows_are_left_out(evaluation: Evaluation, tmp_path: Path) -> None:
    write_predictions(tmp_path / "p.csv", evaluation)
    assert {row["method"] for row in rows_of(tmp_path / "p.csv")} == {"none", "edd-2"}


def test_no_causal_method_at_all_is_said_and_nothing_written(tmp_path: Path) -> None:
    log = simulated_log(Drive(seconds=30.0))
    result = evaluate(log, options=EvaluationOptions(methods=("batch",)))
    with pytest.raises(OutputError, match=r"from the past alone .*--methods"):
        write_predictions(tmp_path / "p.csv", result)
    assert list(tmp_path.iterdir()) == []
