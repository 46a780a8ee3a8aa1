# SPDX-License-Identifier: Apache-2.0
"""The prediction file: one row per prediction and horizon, for anyone to score with their own tools."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from slipwise.calibration.predictions import Predictions
from slipwise.errors import OutputError
from slipwise.evaluation.result import Evaluation
from slipwise.files import write_whole

COLUMNS = (
    *("run", "method", "t_start", "t_end", "horizon", "dx", "dy", "dyaw"),
    *("cov_xx", "cov_xy", "cov_xt", "cov_yy", "cov_yt", "cov_tt", "learned_until", "dof"),
)


LOG = "log"  # of a sequence: the file's place in it, from 0


def write_predictions(path: Path, evaluation: Evaluation) -> None:
    """Write the predictions of all causal methods as CSV: T_start_end predicted from the inputs in between.

    Nothing measured after `learned_until` <= t_start was used. Methods that learned from the windows they
    predict (`batch`, and a model of this very log) have no place in such a file and are left out.

    Raises:
        OutputError: the file cannot be written, or no method is causal.
    """
    _write(path, (evaluation,), COLUMNS)


def write_sequence(path: Path, evaluations: Sequence[Evaluation]) -> None:
    """Write the predictions of a sequence of logs, with a last column that counts the logs from 0.

    What was learned of a log is known when the next begins: `learned_until` is of the log itself.

    Raises:
        OutputError: the file cannot be written, or no method is causal.
    """
    _write(path, evaluations, (*COLUMNS, LOG))


def _write(path: Path, evaluations: Sequence[Evaluation], names: Sequence[str]) -> None:
    import pyarrow as pa
    import pyarrow.csv

    causal = [[p for p in evaluation.predictions if p.causal] for evaluation in evaluations]
    if not any(causal):
        raise OutputError(
            "no method asked for predicts from the past alone", where=str(path), advice="add one to --methods"
        )
    parts = [
        {name: _column(evaluation, rows, name, place) for name in names}
        for place, (evaluation, rows) in enumerate(zip(evaluations, causal, strict=True))
        if rows
    ]
    table = pa.table({name: np.concatenate([part[name] for part in parts]) for name in names})

    def write(temporary: Path) -> None:
        with temporary.open("wb") as file:
            file.write((",".join(names) + "\n").encode())  # pyarrow would put the names in quotes
            pyarrow.csv.write_csv(table, file, pyarrow.csv.WriteOptions(include_header=False))

    write_whole(path, write)


def _column(evaluation: Evaluation, predictions: Sequence[Predictions], name: str, place: int) -> np.ndarray:
    parts = []
    for p in predictions:
        size = len(p.t_start)
        columns = {
            "run": np.array(evaluation.runs, dtype=object)[p.run],
            "method": np.full(size, p.method, dtype=object),
            "t_start": p.t_start,
            "t_end": p.t_end,
            "horizon": np.full(size, p.horizon),
            "learned_until": p.learned_until,
            "dof": p.dof,
            LOG: np.full(size, place),
            **dict(zip(("dx", "dy", "dyaw"), p.pose.T, strict=True)),
        }
        upper = (("xx", 0, 0), ("xy", 0, 1), ("xt", 0, 2), ("yy", 1, 1), ("yt", 1, 2), ("tt", 2, 2))
        columns |= {f"cov_{label}": p.covariance[:, i, j] for label, i, j in upper}
        parts.append(columns[name])
    return np.concatenate(parts)
