# SPDX-License-Identifier: Apache-2.0
"""Logs in turn: the second visit to a surface is known from the first."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from slipwise import _core
from slipwise.errors import LogError, SettingsError
from slipwise.evaluation import EvaluationOptions, evaluate, evaluate_sequence, write_sequence
from slipwise.evaluation.sequence import SequenceEvaluation
from slipwise.logs import Inputs, Log, Poses, Run

RATE, SECONDS = 20.0, 80.0


def drive(yaw_slip: float, seed: int) -> Log:
    """Wheel speeds that are held for 2 s, and the poses of a robot that loses a part of its turns."""
    rng = np.random.default_rng(seed)
    count = round(SECONDS * RATE)
    t = np.arange(count) / RATE
    held = np.arange(count) // 40
    v = rng.uniform(0.3, 1.2, held[-1] + 1)[held]
    omega = rng.uniform(-0.8, 0.8, held[-1] + 1)[held]
    turned = (1.0 - yaw_slip + 0.02 * rng.standard_normal(count)) * omega
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    segment = _core.Segment(0.0, SECONDS, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    history = _core.InputHistory(t, v, np.zeros(count), turned)
    path = _core.integrate_segment(model, np.zeros(2), history, segment, _core.Integrator.Exact)
    x, y, yaw = np.array(path.poses)[:count].T + 0.004 * rng.standard_normal((3, count))
    poses = Poses(
        t=t, x=x, y=y, yaw=np.remainder(yaw + np.pi, 2 * np.pi) - np.pi, frame=np.zeros(count, np.int64)
    )
    return Log((Run("run", None, Inputs(t, v, np.zeros(count), omega), poses),))


@pytest.fixture(scope="module")
def sequence() -> SequenceEvaluation:
    logs = [(f"{k}.csv", drive(slip, k)) for k, slip in enumerate((0.1, 0.5, 0.1, 0.5))]
    return evaluate_sequence(logs, options=EvaluationOptions(horizons=(1.0, 2.0)))


def test_a_surface_that_comes_back_has_the_name_that_it_had(sequence: SequenceEvaluation) -> None:
    first, second, third, fourth = (visit.surface for visit in sequence.visits())
    assert first == third != second == fourth
    assert [surface.visits for surface in sequence.learned.surfaces] == [2, 2]
    assert sequence.good


def test_the_first_windows_of_a_second_visit_are_predicted_better_than_from_nothing(
    sequence: SequenceEvaluation,
) -> None:
    restarted = evaluate(drive(0.5, 3), options=EvaluationOptions(horizons=(2.0,), methods=("none", "auto")))
    from_nothing = next(p for p in restarted.predictions if p.method == "auto").heading_error[:10].mean()
    assert sequence.visits()[3].first_heading < 0.5 * from_nothing


def test_beside_a_memory_stands_one_learner_that_goes_on_without(sequence: SequenceEvaluation) -> None:
    visits, logs = sequence.visits(), [drive(slip, k) for k, slip in enumerate((0.1, 0.5, 0.1, 0.5))]
    together = Log(tuple(run for log in logs for run in log.runs))
    alone = evaluate(together, options=EvaluationOptions(horizons=(2.0,), methods=("none", "auto")))
    errors = next(p for p in alone.predictions if p.method == "auto").position_error
    ends = np.cumsum([visit.windows for visit in visits])[:-1]
    means = [float(each.mean()) for each in np.split(errors, ends)]
    assert [visit.going_on_position for visit in visits] == means
    assert sequence.gain is not None
    assert sequence.gain[1] < 1.0


def test_the_first_log_is_predicted_as_without_a_memory(sequence: SequenceEvaluation) -> None:
    alone = evaluate(drive(0.1, 0), options=EvaluationOptions(horizons=(1.0, 2.0), methods=("none", "auto")))
    for own, other in zip(sequence.evaluations[0].predictions, alone.predictions, strict=True):
        assert own.method == other.method
        assert np.array_equal(own.pose, other.pose)
        assert np.array_equal(own.covariance, other.covariance)


def test_every_prediction_uses_nothing_measured_after_its_start(sequence: SequenceEvaluation) -> None:
    assert all(p.causal for evaluation in sequence.evaluations for p in evaluation.predictions)


def test_the_prediction_file_counts_the_logs(sequence: SequenceEvaluation, tmp_path: Path) -> None:
    write_sequence(tmp_path / "p.csv", sequence.evaluations)
    with (tmp_path / "p.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[-1] == "log"
    assert [row["log"] for row in rows] == sorted(row["log"] for row in rows)
    for place, evaluation in enumerate(sequence.evaluations):
        wanted = sum(len(p) for p in evaluation.predictions)
        assert sum(row["log"] == str(place) for row in rows) == wanted


def test_what_has_no_memory_is_refused_alone() -> None:
    with pytest.raises(SettingsError, match="memory"):
        evaluate_sequence([("a", drive(0.1, 0))], options=EvaluationOptions(methods=("none", "edd-2")))
    with pytest.raises(LogError, match="needs a log"):
        evaluate_sequence([])
