# SPDX-License-Identifier: Apache-2.0
"""The curves of a car in a model file, and what uses them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from sample_cars import changed_car, true_car, write_car_log
from sample_models import make_model, named

import slipwise as sw
from slipwise import _core
from slipwise.calibration.learned_log import new_learner, pushed
from slipwise.calibration.prepared_run import prepare_run
from slipwise.errors import ModelError
from slipwise.export import export_model
from slipwise.fleet.vehicle_numbers import vehicle_numbers
from slipwise.logs import Log, LogOptions
from slipwise.models.car import KnotCurveSection
from slipwise.models.difference import differences
from slipwise.models.step_response import rise_times
from slipwise.planning import Planner, curvature_map, lattice_primitives


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    path = write_car_log(tmp_path_factory.mktemp("car") / "car.csv", 120.0)
    return sw.open_log(path, options=LogOptions(vehicle="dart"))


@pytest.fixture(scope="module")
def model(log: Log) -> sw.Model:
    return sw.calibrate(log).model


def test_knots_that_do_not_increase_are_refused() -> None:
    with pytest.raises(ValueError, match="increase"):
        KnotCurveSection(at=[0.0, 0.0], value=[0.0, 1.0], std=[0.0, 0.0])
    with pytest.raises(ValueError, match="each knot"):
        KnotCurveSection(at=[0.0, 1.0], value=[0.0], std=[0.0, 0.0])


def test_the_curves_are_learned_and_saved(model: sw.Model, tmp_path: Path) -> None:
    loaded = sw.load_model(model.save(tmp_path / "car.yaml"))
    assert loaded.content == model.content
    assert loaded.car is not None
    true = true_car()
    for throttle, std in zip(loaded.car.speed.at, loaded.car.speed.std, strict=True):
        if 0.0 <= throttle <= 0.6:
            off = np.interp(throttle, loaded.car.speed.at, loaded.car.speed.value) - np.interp(
                throttle, true.speed.at, true.speed.value
            )
            assert abs(off) < max(3.0 * std, 0.1)


def test_a_model_of_speeds_says_nothing_of_a_car() -> None:
    from sample_logs import Drive, simulated_log

    text = sw.calibrate(simulated_log(Drive(seconds=40.0))).model.to_yaml()
    assert "\ncar:" not in text


def test_what_takes_speeds_refuses_such_a_model(model: sw.Model) -> None:
    with pytest.raises(ModelError, match="throttle and steering"):
        export_model(model, "c-header", name="car", force=True)
    for use in (Planner, curvature_map, lattice_primitives):
        with pytest.raises(ModelError, match="throttle and steering"):
            use(model)


def learned(folder: Path, seed: int, *, car: _core.CarCurves | None = None, fastest: float = 0.8) -> sw.Model:
    path = write_car_log(folder / f"car-{seed}.csv", 120.0, seed, car=car, fastest=fastest)
    return sw.calibrate(sw.open_log(path, options=LogOptions(vehicle="dart"))).model


def test_a_second_run_by_another_car_is_learned_as_from_nothing(log: Log, tmp_path: Path) -> None:
    other = changed_car(speed=0.6, curvature=1.3)
    path = write_car_log(tmp_path / "other.csv", 60.0, 3, car=other)
    second = sw.open_log(path, options=LogOptions(vehicle="dart"))
    alone = sw.calibrate(second).model.car
    after = sw.calibrate(dataclasses.replace(second, runs=(*log.runs, *second.runs))).model.car
    assert alone is not None
    assert after is not None
    assert after.speed.value == pytest.approx(alone.speed.value, abs=0.02)
    assert after.curvature.value == pytest.approx(alone.curvature.value, abs=0.02)


def test_a_learner_saved_between_runs_goes_on_to_the_byte(tmp_path: Path) -> None:
    runs = []
    for seed, car in ((1, true_car()), (2, changed_car(0.6, 1.3)), (3, changed_car(0.6, 1.3))):
        path = write_car_log(tmp_path / f"{seed}.csv", 30.0, seed, car=car)
        runs.append(prepare_run(sw.open_log(path, options=LogOptions(vehicle="dart")), "command"))
    whole = new_learner([each.run for each in runs[0]], "command", sw.Settings(), (1.0,))
    saved = _core.MotionLearner.load(whole.save())
    for run in runs:
        list(pushed(whole, run))
        list(pushed(saved, run))
        saved = _core.MotionLearner.load(saved.save())
    assert saved.save() == whole.save()


def test_what_is_shown_of_a_car_is_its_curves_and_lags(model: sw.Model) -> None:
    said = str(sw.summarise(model))
    assert "Follows commands at once" not in said
    assert "Follows the throttle with a time constant of 0.4" in said
    assert "At a throttle of 0.8 it drives 2.3" in said or "At a throttle of 0.6 it drives 2.0" in said
    span = model.content.range
    assert span.throttle == pytest.approx([0.0, 0.8], abs=0.1)
    assert span.speed[1] == pytest.approx(2.3, abs=0.2)


def squared(model: sw.Model, car: _core.CarCurves, throttle: float, steering: float) -> float:
    """How far the true pose after 3 s from rest is from what is predicted, squared, in its own covariance."""
    t = np.arange(0.0, 3.0, 0.05)
    told = np.full(len(t), throttle), np.full(len(t), steering)
    twists = car.twists(_core.InputHistory(t, told[0], np.zeros(len(t)), told[1]), 0.0, None).rows()
    pose = _core.Pose2(0.0, 0.0, 0.0)
    for _, v, vy, omega in twists.tolist()[: len(t)]:
        pose = _core.compose(pose, _core.exp(np.array([v, vy, omega]) * 0.05))
    path = sw.predict(model, np.column_stack((t, *told)), horizon=3.0)
    off = pose.vector() - path.end
    return float(off @ np.linalg.solve(path.covariance[-1], off))


def test_a_throttle_that_was_never_driven_is_as_uncertain_as_its_curve(tmp_path: Path) -> None:
    model = learned(tmp_path, 7, fastest=0.4)
    assert model.car is not None

    def wide(throttle: float) -> float:
        path = sw.predict(model, [(0.0, throttle, 0.0)], horizon=4.0)
        return float(np.sqrt(path.covariance[-1, 0, 0]))

    std = dict(zip(model.car.speed.at, model.car.speed.std, strict=True))
    assert wide(0.3) < 0.5
    assert wide(1.0) > 2.0 * std[1.0]


@pytest.mark.slow
def test_the_truth_lies_within_what_is_predicted_at_throttles_driven_and_not(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    inside, beyond = [], []
    for seed in range(20, 32):
        car = changed_car(*rng.uniform(0.6, 1.4, 2))
        model = learned(tmp_path, seed, car=car, fastest=0.5)
        for throttles, found in (((0.15, 0.5), inside), ((0.6, 1.0), beyond)):
            found += [squared(model, car, rng.uniform(*throttles), rng.uniform(-0.9, 0.9)) for _ in range(10)]
    within = {name: np.mean(np.array(each) < 7.81) for name, each in (("in", inside), ("beyond", beyond))}
    assert all(share > 0.85 for share in within.values()), within


def test_a_car_is_as_late_as_delay_and_lag_of_its_curves_together() -> None:
    curves = (_core.KnotCurve([-1.0, 1.0], [-2.0, 2.0], [0.0] * 2),) * 2
    car = _core.CarCurves(*curves, 0.4, 0.1, 0.15, 0.08, 0.2)
    covariance = np.zeros((9, 9))
    covariance[np.ix_((4, 8), (4, 8))] = [[0.0101, -0.01], [-0.01, 0.01]]  # of lag and delay
    model = make_model(
        dataclasses.replace(named("edd-2"), commands=True, car=car.with_spread(covariance, np.ones(9)))
    )
    late = rise_times(model)
    assert late["63 % of a step of speed"] == pytest.approx((0.6, 0.01))
    assert late["63 % of a step of steering"] == pytest.approx((0.3, 0.1))
    assert vehicle_numbers(model).lag_speed == pytest.approx(0.6)
    assert {"63 % of a step of speed"} <= {row.name for row in differences(model, model)}
