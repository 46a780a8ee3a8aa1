# SPDX-License-Identifier: Apache-2.0
"""The curves of a car in a model file, and what uses them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_cars import true_car, write_car_log

import slipwise as sw
from slipwise.errors import ModelError
from slipwise.export import export_model
from slipwise.logs import Log, LogOptions
from slipwise.models.car import car_section, core_car
from slipwise.models.schema import KnotCurveSection
from slipwise.planning import Planner, curvature_map, lattice_primitives


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Log:
    path = write_car_log(tmp_path_factory.mktemp("car") / "car.csv", 120.0)
    return sw.open_log(path, options=LogOptions(vehicle="dart"))


@pytest.fixture(scope="module")
def model(log: Log) -> sw.Model:
    return sw.calibrate(log).model


def test_a_section_goes_to_the_core_and_back() -> None:
    section = car_section(true_car())
    assert car_section(core_car(section)) == section


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


def driven(model: sw.Model, throttle: float, initial: tuple[float, float] | None = None) -> float:
    """Metres along the path that is predicted for five seconds."""
    poses = sw.predict(model, [(0.0, throttle, 0.0)], horizon=5.0, initial=initial).poses
    return float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())


def test_predict_takes_throttle_and_steering(model: sw.Model) -> None:
    at_speed, from_rest = driven(model, 0.6, (2.0, 0.0)), driven(model, 0.6)
    assert at_speed == pytest.approx(10.0, rel=0.1)
    assert from_rest == pytest.approx(at_speed - 0.8, rel=0.1)  # a lag of 0.4 s at 2 m/s
    assert driven(model, 0.1) < 0.4


def test_what_takes_speeds_refuses_such_a_model(model: sw.Model) -> None:
    with pytest.raises(ModelError, match="throttle and steering"):
        export_model(model, "c-header", name="car", force=True)
    for use in (Planner, curvature_map, lattice_primitives):
        with pytest.raises(ModelError, match="throttle and steering"):
            use(model)
