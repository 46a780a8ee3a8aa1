# SPDX-License-Identifier: Apache-2.0
"""Where the pose sensor sits: known, learned, or not to be told from slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import Drive, poses_of, simulated_log
from sample_models import Made, make_model, named

import slipwise as sw
from slipwise import _core
from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.errors import SettingsError
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import Log
from slipwise.models.sensor_look import sensor_look, sensor_sentences

SENSOR = (1.2, -0.3, 0.15)
SLIP = (-0.08, -0.3)  # lon.V, ang.w
DRIVE = Drive(seconds=150.0, basis=_core.named_basis("edd-2"), alpha=SLIP)


def seen_by_sensor(log: Log, sensor: tuple[float, float, float] = SENSOR) -> Log:
    """The same drive with the poses of a sensor away from base_link."""
    (run,) = log.runs
    sensor_extrinsics = _core.Pose2(*sensor)
    columns = (run.poses.x.tolist(), run.poses.y.tolist(), run.poses.yaw.tolist())
    path = [
        _core.compose(_core.Pose2(*pose), sensor_extrinsics).vector() for pose in zip(*columns, strict=True)
    ]
    return replace(log, runs=(replace(run, poses=poses_of(run.poses.t, np.array(path))),))


@pytest.fixture(scope="module")
def log() -> Log:
    return seen_by_sensor(simulated_log(DRIVE))


def calibrated(
    log: Log, sensor_extrinsics: dict[str, object], *, basis: str = "edd-2", source: str = "wheel"
) -> Calibration:
    settings = make_settings({"basis": basis, "sensor_extrinsics": sensor_extrinsics})
    return calibrate(log, input=source, settings=settings)


def value(result: Calibration, name: str) -> tuple[float, float, float]:
    """Value, standard deviation and prior standard deviation of a parameter."""
    (found,) = (p for p in result.model.content.parameters if p.name == name)
    return found.value, found.std, found.prior_std


@pytest.mark.parametrize("source", ["wheel", "command"])
def test_the_place_of_the_sensor_is_learned(log: Log, source: str) -> None:
    result = calibrated(log, {"learn": True}, source=source)
    for name, true in zip(
        ("sensor_x", "sensor_y", "sensor_yaw", "lon.V", "ang.w"), (*SENSOR, *SLIP), strict=True
    ):
        found, std, prior_std = value(result, name)
        assert abs(found - true) < 3.0 * std, name
        assert std < 0.2 * prior_std, name
    assert result.model.content.sensor_extrinsics


def test_a_known_place_gives_the_slip_of_base_link(log: Log) -> None:
    sensor_extrinsics = dict(zip(("x", "y", "yaw"), SENSOR, strict=True))
    known, ignored = (
        calibrated(log, sensor_extrinsics, basis="full-linear-6"),
        calibrated(log, {}, basis="full-linear-6"),
    )
    at_base = calibrated(simulated_log(DRIVE), {}, basis="full-linear-6")
    for name in ("lon.V", "ang.w", "lat.w", "lat.V"):
        assert value(known, name)[0] == pytest.approx(value(at_base, name)[0], abs=0.03), name
    taken_for_slip = SENSOR[0] * (1.0 + SLIP[1])  # the lever arm, times the true yaw rate over the wheels'
    assert value(ignored, "lat.w")[0] == pytest.approx(taken_for_slip, abs=0.1)
    assert not known.model.content.sensor_extrinsics
    assert known.model.content.provenance.settings["sensor_extrinsics"] == sensor_extrinsics


def test_evaluation_compares_the_poses_of_the_sensor(log: Log) -> None:
    sensor_extrinsics = dict(zip(("x", "y", "yaw"), SENSOR, strict=True))
    errors = []
    for given, drive in ((sensor_extrinsics, log), ({}, simulated_log(DRIVE)), ({"learn": True}, log)):
        settings = make_settings({"basis": "edd-2", "sensor_extrinsics": given})
        options = EvaluationOptions(horizons=(2.0,), methods=("none", "edd-2", "iekf"))
        scores = evaluate(drive, input="wheel", settings=settings, options=options).scores
        errors.append({score.method: score.position.mean for score in scores})
    known, at_base, learned = errors
    for method in ("edd-2", "iekf"):
        assert known[method] == pytest.approx(at_base[method], rel=0.25), method
    assert learned["edd-2"] < 1.3 * at_base["edd-2"]


def test_a_lever_and_a_slip_that_confounded_are_both_left_open(log: Log) -> None:
    result = calibrated(log, {"learn": True}, basis="full-linear-6")
    for one, other in (("sensor_x", "lat.w"), ("sensor_y", "lon.w"), ("sensor_yaw", "lat.V")):
        names = [p.name for p in result.model.content.parameters]
        i, j = names.index(one), names.index(other)
        covariance = result.model.covariance
        correlation = covariance[i, j] / np.sqrt(covariance[i, i] * covariance[j, j])
        assert abs(correlation) > 0.9, one
        true = dict(zip(("sensor_x", "sensor_y", "sensor_yaw"), SENSOR, strict=True))[one]
        found, std, _ = value(result, one)
        assert abs(found - true) < 3.0 * std, one


def test_a_sensor_far_from_any_robot_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"sensor_extrinsics\.x"):
        make_settings({"sensor_extrinsics": {"x": 1500.0}})


@pytest.mark.parametrize("source", ["wheel", "command"])
def test_slip_that_looks_like_a_sensor_names_its_place(log: Log, source: str) -> None:
    unknown = calibrated(log, {}, basis="full-linear-6", source=source).model
    look = sensor_look(unknown)
    for axis, true in enumerate(SENSOR):
        assert abs(look.pose[axis] - true) < 3.0 * look.std[axis] + 0.01, axis
    (sentence,) = sensor_sentences(unknown)
    assert "m ahead of and" in sentence
    assert "m right of the centre of turning" in sentence
    given = dict(zip(("x", "y", "yaw"), SENSOR, strict=True))
    assert not sensor_sentences(calibrated(log, given, basis="full-linear-6", source=source).model)
    learned = calibrated(log, {"learn": True}, basis="full-linear-6", source=source).model
    assert not sensor_sentences(learned)


def test_a_sensor_at_the_centre_of_turning_is_not_spoken_of() -> None:
    log = seen_by_sensor(simulated_log(DRIVE), (0.02, 0.01, 0.01))
    assert not sensor_sentences(calibrated(log, {}, basis="full-linear-6").model)


def test_slip_that_is_bent_or_told_on_one_circle_alone_is_no_place_of_a_sensor() -> None:
    """Side slip by V*w is the arm of no sensor; on one circle, an arm is like any slip."""
    bent = make_model(Made(_core.Basis("bent", [], ["V*w", "w"], []), {"lat.V*w": 0.3}))
    assert not sensor_sentences(bent)
    arm = replace(named("full-linear-6", lat__w=0.3), std=0.001)
    (sentence,) = sensor_sentences(make_model(arm))
    assert "m ahead of the centre of turning" in sentence
    assert not sensor_sentences(make_model(replace(arm, speed=(0.5, 0.5), yaw_rate=(0.3, 0.3))))


def test_a_model_is_judged_by_the_sensor_that_it_was_told_of(log: Log) -> None:
    place = dict(zip(("x", "y", "yaw"), SENSOR, strict=True))
    model = calibrated(log, place).model
    options = EvaluationOptions(horizons=(2.0,), methods=("none",), model=model)
    told = make_settings({"basis": "edd-2", "sensor_extrinsics": place})
    errors = [
        evaluate(log, input="wheel", settings=settings, options=options).score("model", 2.0).position.mean
        for settings in (told, None)
    ]
    assert errors[0] == errors[1] < 0.03
    assert sw.compare(model, model, log).evaluation.score("old", 2.0).position.mean == errors[0]
