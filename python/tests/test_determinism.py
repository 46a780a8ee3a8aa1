# SPDX-License-Identifier: Apache-2.0
"""The same log and settings give the same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_logs import Drive, simulated_log

from slipwise.calibration import Settings, calibrate
from slipwise.evaluation import EvaluationOptions, evaluate, write_predictions
from slipwise.logs import Log, open_log

OPTIONS = EvaluationOptions(methods=("none", "edd-2", "auto"))


def log_of(source: str, request: pytest.FixtureRequest) -> Log:
    if source == "simulated":
        return simulated_log(Drive(seconds=60.0))
    folder: Path = request.getfixturevalue("real_log_dir")
    return open_log(folder / "warthog/grass_8_8_16h11s19.csv.gz")


@pytest.mark.parametrize("estimator", ["average", "batch"])
@pytest.mark.parametrize("source", ["simulated", "real"])
def test_model_files_are_equal_byte_by_byte(
    source: str, estimator: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    settings = Settings(estimator=estimator)
    paths = [
        calibrate(log_of(source, request), input="wheel", settings=settings).model.save(tmp_path / name)
        for name in ("one.yaml", "two.yaml")
    ]
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize("source", ["simulated", "real"])
def test_prediction_files_and_scores_are_equal_byte_by_byte(
    source: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    results = [evaluate(log_of(source, request), input="wheel", options=OPTIONS) for _ in range(2)]
    paths = [tmp_path / "one.csv", tmp_path / "two.csv"]
    for path, result in zip(paths, results, strict=True):
        write_predictions(path, result)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    assert repr(results[0].scores) == repr(results[1].scores)


def test_horizons_asked_for_together_or_alone_give_the_same_predictions() -> None:
    log = simulated_log(Drive(seconds=60.0))
    together = evaluate(log, options=EvaluationOptions(methods=("auto",), horizons=(1.0, 2.0, 5.0)))
    (alone,) = evaluate(log, options=EvaluationOptions(methods=("auto",), horizons=(2.0,))).predictions
    among = next(p for p in together.predictions if p.horizon == 2.0)
    assert among.pose.tobytes() == alone.pose.tobytes()
    assert among.covariance.tobytes() == alone.covariance.tobytes()
