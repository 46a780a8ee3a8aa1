# SPDX-License-Identifier: Apache-2.0
"""A prediction file gets the scores that `evaluate` gives the same predictions."""

from __future__ import annotations

import csv
import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.errors import LogError
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate, score_predictions, write_predictions
from slipwise.logs import Log

SLIP = Drive(seconds=40.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.3), name="a, b")
LOG = Log((simulated_run(SLIP), simulated_run(replace(SLIP, seed=2, name="c"))))


@pytest.fixture(scope="module")
def evaluation() -> Evaluation:
    return evaluate(LOG, options=EvaluationOptions(methods=("none", "edd-2")))


@pytest.fixture
def file(evaluation: Evaluation, tmp_path: Path) -> Path:
    write_predictions(tmp_path / "p.csv", evaluation)
    return tmp_path / "p.csv"


def change(file: Path, **columns: str | None) -> None:
    """Write columns anew: another value, or none of them."""
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    for row in rows:
        for name, value in columns.items():
            if value is None:
                del row[name]
            else:
                row[name] = value
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def test_the_scores_are_those_of_evaluate(evaluation: Evaluation, file: Path) -> None:
    scored = score_predictions(file, LOG)
    own = {"in_sample_position", "in_sample_heading"}  # after learning a window; no such file says it
    inflated = {"reported_nis", "reported_coverage"}
    for score in scored.scores:
        found, expected = asdict(score), asdict(evaluation.score(score.method, score.horizon))
        for name in found.keys() - own - inflated:
            np.testing.assert_equal(found[name], expected[name], name)


def test_without_covariances_there_is_no_nis(file: Path) -> None:
    change(file, **dict.fromkeys(("cov_xx", "cov_xy", "cov_xt", "cov_yy", "cov_yt", "cov_tt", "dof"), None))
    score = score_predictions(file, LOG).score("edd-2", 5.0)
    assert score.position_ratio[0] < 1.0
    assert np.isnan([score.nis, *score.coverage, score.reported_nis, *score.reported_coverage]).all()


def test_what_has_looked_ahead_is_not_causal(file: Path) -> None:
    assert all(score.causal for score in score_predictions(file, LOG).scores)
    change(file, learned_until="1e9")
    assert not any(score.causal for score in score_predictions(file, LOG).scores)


def test_a_perfect_prediction_has_no_error(file: Path, evaluation: Evaluation) -> None:
    change(file, method="perfect")
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    measured = {
        (evaluation.runs[p.run[i]], p.horizon, p.t_start[i]): p.measured[i]
        for p in evaluation.predictions
        for i in range(len(p))
    }
    kept = {}
    for row in rows:
        key = (row["run"], float(row["horizon"]), float(row["t_start"]))
        kept[key] = {**row, **dict(zip(("dx", "dy", "dyaw"), map(repr, measured[key].tolist()), strict=True))}
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(kept.values())
    for score in score_predictions(file, LOG).scores:
        assert score.position.mean == pytest.approx(0.0, abs=1e-12)
        assert score.coverage == (1.0, 1.0, 1.0)
        assert math.isnan(score.position_to_rival)


def test_a_horizon_without_windows_is_an_error(file: Path) -> None:
    change(file, horizon="300")
    with pytest.raises(LogError, match="no two windows of any horizon"):
        score_predictions(file, LOG)
