# SPDX-License-Identifier: Apache-2.0
"""The prediction file: one row per prediction and horizon, for anyone to score with their own tools."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipwise.evaluation.result import Evaluation
from slipwise.files import write_whole

COLUMNS = (
    *("run", "method", "t_start", "t_end", "horizon", "dx", "dy", "dyaw"),
    *("cov_xx", "cov_xy", "cov_xt", "cov_yy", "cov_yt", "cov_tt", "learned_until"),
)


def write_predictions(path: Path, evaluation: Evaluation) -> None:
    """Write all predictions of all methods as CSV: T_start_end predicted from the inputs in [t_start, t_end].

    Nothing measured after `learned_until` <= t_start was used.

    Raises:
        OutputError: the file cannot be written.
    """
    import pyarrow as pa
    import pyarrow.csv

    table = pa.table({name: _column(evaluation, name) for name in COLUMNS})
    write_whole(path, lambda temporary: pyarrow.csv.write_csv(table, temporary))


def _column(evaluation: Evaluation, name: str) -> np.ndarray:
    parts = []
    for p in evaluation.predictions:
        size = len(p.t_start)
        columns = {
            "run": np.array(evaluation.runs, dtype=object)[p.run],
            "method": np.full(size, p.method, dtype=object),
            "t_start": p.t_start,
            "t_end": p.t_end,
            "horizon": np.full(size, p.horizon),
            "learned_until": p.learned_until,
            **dict(zip(("dx", "dy", "dyaw"), p.pose.T, strict=True)),
        }
        upper = (("xx", 0, 0), ("xy", 0, 1), ("xt", 0, 2), ("yy", 1, 1), ("yt", 1, 2), ("tt", 2, 2))
        columns |= {f"cov_{label}": p.covariance[:, i, j] for label, i, j in upper}
        parts.append(columns[name])
    return np.concatenate(parts)
