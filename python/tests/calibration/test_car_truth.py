# SPDX-License-Identifier: Apache-2.0
"""A car commanded by throttle and steering, learned from a table, live, and beside a kinematic bicycle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_cars import write_car_log

import slipwise as sw
from slipwise.calibration import make_settings
from slipwise.calibration.core_settings import core_settings
from slipwise.errors import SettingsError
from slipwise.logs import Log, LogOptions


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    path = write_car_log(tmp_path_factory.mktemp("car") / "car.csv", 120.0)
    return sw.open_log(path, options=LogOptions(vehicle="dart"))


def test_the_curves_predict_several_times_better_than_the_best_bicycle(log: Log) -> None:
    held_out = sw.calibrate(log).model.content.verdict.held_out
    assert held_out is not None
    assert held_out.position < 0.4 * held_out.baseline_position
    assert held_out.heading < 0.5 * held_out.baseline_heading


def test_behind_curves_little_else_is_looked_for(log: Log) -> None:
    (run,) = log.runs
    assert run.commands is not None
    assert run.commands.car is not None
    core = core_settings(make_settings({}), "command", (1.0,), car=run.commands.car.prior())
    assert [basis.name for basis in core.hypotheses.bases] == ["none", "edd-2"]
    assert core.stream.car is not None
    wheels = core_settings(make_settings({}), "wheel", (1.0,), car=run.commands.car.prior())
    assert wheels.stream.car is None


def test_other_estimators_refuse_throttle_and_steering(log: Log) -> None:
    with pytest.raises(SettingsError, match="average of bases"):
        sw.calibrate(log, settings=make_settings({"estimator": "iekf", "basis": "edd-2"}))


def test_a_path_of_the_vehicle_is_said_where_it_is_wrong(tmp_path: Path) -> None:
    file = tmp_path / "car.yaml"
    file.write_text(
        "vehicle:\n  tracks: {radius: 0.1, separation: 0.3}\n"
        "  throttle_steering: {top_speed: 3, curvature: 2}\n"
    )
    with pytest.raises(SettingsError, match="wheelbase"):
        LogOptions(vehicle=str(file))


def test_a_model_of_throttle_is_judged_as_it_is_on_another_log(log: Log, tmp_path: Path) -> None:
    other = sw.open_log(write_car_log(tmp_path / "other.csv", 60.0, 2), options=LogOptions(vehicle="dart"))
    model = sw.calibrate(log).model
    options = sw.EvaluationOptions(horizons=(1.0,), methods=("none", "auto", "model"), model=model)
    found = sw.evaluate(other, options=options)
    error = {score.method: score.position.mean for score in found.scores}
    assert error["model"] < 0.1 * error["none"]
    assert error["model"] < 1.1 * error["auto"]
    starts = [list(each.t_start) for each in found.predictions]
    assert starts[0] == starts[1] == starts[2]
    # Nothing that was measured later reaches a prediction.
    begin = sw.evaluate(cut_log(other, 40.0), options=options).predictions[2]
    whole, count = found.predictions[2], len(begin.t_start) - 1  # the last one ends with the log
    assert 30 < count < len(whole.t_start)
    assert begin.t_end[:count].tolist() == whole.t_end[:count].tolist()
    assert begin.pose[:count].tolist() == whole.pose[:count].tolist()


def cut_log(log: Log, seconds: float) -> Log:
    run = log.runs[0]
    poses = run.poses
    assert poses.measured is None
    rows = slice(0, int(np.searchsorted(poses.t, poses.t[0] + seconds)))
    parts = {name: getattr(poses, name)[rows] for name in ("t", "x", "y", "yaw", "frame")}
    return replace(log, runs=(replace(run, poses=replace(poses, **parts)),))


def test_a_model_of_throttle_asks_for_a_log_of_throttle(log: Log) -> None:
    run = log.runs[0]
    assert run.commands is not None
    speeds = replace(log, runs=(replace(run, commands=replace(run.commands, car=None)),))
    options = sw.EvaluationOptions(horizons=(1.0,), methods=("model",), model=sw.calibrate(log).model)
    with pytest.raises(SettingsError, match="the log has none"):
        sw.evaluate(speeds, options=options)
