# SPDX-License-Identifier: Apache-2.0
"""Rows of a file that are pushed give what `evaluate` and `calibrate` write, saved and loaded or not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from online.csv_program import Item, inputs_ahead, push, read_runs, seconds_between

from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.calibration.calibrate import JUDGING_HORIZONS
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.settings import Settings
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import Log, open_log
from slipwise.models import Model, schema

#: A path is by the clock of its inputs, a held-out pose by that of its sensor: they are one here.
SETTINGS = Settings(learn_clock_offset=False)
STREAMS = {"command": "command", "wheel": "wheels"}
BOTH = ("wheel", "command")
SHORT = (("warthog/grass_7_29_14h8s51", BOTH), ("tricycle/agv", ("wheel",)))
LONG = (
    ("warthog/grass_8_8_15h56s39", ("wheel",)),  # poses at 5 Hz, attitudes
    ("husky/tile_deflated_tyres", ("wheel",)),  # duplicate stamps, many runs
    ("husky/wetgrass_bad_poses", ("command",)),  # poses jump
    ("warthog_windows/gravel_8_6_11h37s32", ("wheel",)),  # each 2 s have a frame of their own
    ("race_car/LVMS_23_01_04_B", ("wheel",)),  # no column says which poses are new
    ("f1tenth/DS3", ("command",)),
    ("robotino/table_gray", ("command",)),
)


def cases(logs: Sequence[tuple[str, tuple[str, ...]]]) -> list[tuple[str, str]]:
    return [(name, input_name) for name, inputs in logs for input_name in inputs]


def new_learner(log: Log, input_name: str, horizons: Sequence[float]) -> _core.MotionLearner:
    settings = for_the_ground_of(log, SETTINGS)
    return _core.MotionLearner(core_settings(settings, input_name, horizons))


class MovingLearner:
    """A learner that moves to another robot now and then: after some rows it is saved, and loaded again."""

    SAVES = 30  # of a log

    def __init__(self, log: Log, input_name: str, horizons: Sequence[float], path: Path) -> None:
        self.now = new_learner(log, input_name, horizons)
        rows = sum(len(run.items) for run in read_runs(path))
        self._after = set(np.random.default_rng(5).integers(rows, size=self.SAVES).tolist())
        self._pushed = 0

    def push(self, item: Item) -> None:
        push(self.now, item)
        if self._pushed in self._after:
            self.now = _core.MotionLearner.load(self.now.save())
        self._pushed += 1


def evaluated(log: Log, input_name: str, horizons: tuple[float, ...]) -> Sequence[Predictions]:
    """What `evaluate` predicts."""
    options = EvaluationOptions(horizons=horizons, methods=("auto",))
    return evaluate(log, input=input_name, settings=SETTINGS, options=options).predictions


def replayed(
    path: Path, input_name: str, log: Log, expected: Sequence[Predictions]
) -> tuple[_core.MotionLearner, list[str]]:
    """Push a file's rows, asking for what is expected; return the learner, and what differs."""
    horizons = [p.horizon for p in expected]
    learner, compared, differing = MovingLearner(log, input_name, horizons, path), 0, list[str]()
    names = {run.name: k for k, run in enumerate(log.runs)}
    for run in read_runs(path):
        learner.now.start_run()
        at = {
            (p.t_start[i], k): i
            for k, p in enumerate(expected)
            for i in np.flatnonzero(p.run == names[run.name]).tolist()
        }
        for place, item in enumerate(run.items):
            learner.push(item)
            for k, p in enumerate(expected):
                i = at.get((item[1][0], k)) if item[0] == "pose" else None
                if i is not None:
                    end = float(p.t_end[i])
                    ahead = inputs_ahead(run, place, STREAMS[input_name], end)
                    seconds = seconds_between(float(p.t_start[i]), end)
                    path_ahead = learner.now.predict(ahead, seconds, p.horizon, np.zeros((0, 3)), None)
                    compared += 1
                    differing += difference(p, i, path_ahead)
    assert compared == sum(len(p) for p in expected)
    assert compared > 0
    return learner.now, differing


def difference(p: Predictions, i: int, other: _core.PredictedPath) -> list[str]:
    pairs = {
        "pose": (p.pose[i], other.poses[-1]),
        "covariance": (p.covariance[i], other.covariances[-1]),
        "inflation": (p.inflation[i], other.students[-1].inflation),
        "dof": (p.dof[i], other.students[-1].dof),
        "structure": (p.structure[i], other.structure),
    }
    unequal = [name for name, (a, b) in pairs.items() if not np.array_equal(a, b)]
    largest = np.abs(p.pose[i] - other.poses[-1]).max()
    where = f"run {p.run[i]}, t = {p.t_start[i]}, horizon {p.horizon}"
    return [f"{where}: {', '.join(unequal)} (pose by {largest:g})"] if unequal else []


def same_model(
    content: schema.ModelFile, learned: _core.LearnedModel, limits: _core.ActuatorLimits | None
) -> None:
    """Both hold the same, to the last bit; `limits` are what was found of the actuator's."""
    kept = None if limits is None else limits.posterior
    assert (content.limit_gains is not None) == (kept is not None)
    table = Model(content).vector
    posterior, noise = kept or learned.motion, content.noise
    assert table.names == [info.name for info in posterior.model.parameters]
    assert table.values.tolist() == posterior.estimate.mean.tolist()
    assert [p.prior_std for p in table.rows] == list(posterior.prior_std)
    assert table.covariance.tolist() == posterior.estimate.covariance.tolist()
    assert noise.variance_scale == list(posterior.noise_scale)
    assert list(content.weights.values()) == list(posterior.basis_weights)
    students = {h: s for h, s in zip(JUDGING_HORIZONS, learned.students, strict=True) if h in noise.student_t}
    assert [(t.inflation, t.dof) for t in noise.student_t.values()] == [
        (s.inflation, s.dof) for s in students.values()
    ]
    assert content.slip_disturbance is not None
    law = learned.disturbance.law
    assert [disturbance.weight for disturbance in content.slip_disturbance.candidates] == list(law.weights)
    assert content.provenance.learned_segments == learned.segments
    assert content.range.speed + content.range.yaw_rate == list(learned.range)


def check(folder: Path, name: str, input_name: str, *, evaluating: bool) -> None:
    """The rows give the model and the predictions of `calibrate`, or those of `evaluate`."""
    path = folder / f"{name}.csv.gz"
    log = open_log(path)
    learned = calibrate(log, input=input_name, settings=SETTINGS)
    expected = evaluated(log, input_name, JUDGING_HORIZONS) if evaluating else learned.predictions
    learner, differing = replayed(path, input_name, log, expected)
    assert not differing, f"{len(differing)} predictions differ: {differing[0]}"
    limits = learner.find_limits(SETTINGS.wheel_separation)
    same_model(learned.model.content, learner.model(), limits)


@pytest.mark.parametrize(("name", "input_name"), cases(SHORT))
def test_rows_pushed_one_by_one_give_what_evaluate_and_calibrate_write(
    real_log_dir: Path, name: str, input_name: str
) -> None:
    check(real_log_dir, name, input_name, evaluating=True)


def test_predictions_of_less_than_a_second_are_the_same_too(real_log_dir: Path) -> None:
    path = real_log_dir / "warthog/grass_7_29_14h8s51.csv.gz"
    log = open_log(path)
    _, differing = replayed(path, "command", log, evaluated(log, "command", (0.5, 10.0)))
    assert not differing, differing[0]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "input_name"), cases(LONG))
def test_rows_of_long_logs_give_what_calibrate_writes(real_log_dir: Path, name: str, input_name: str) -> None:
    check(real_log_dir, name, input_name, evaluating=False)
