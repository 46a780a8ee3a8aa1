# SPDX-License-Identifier: Apache-2.0
"""A model that has learned where its pose sensor sits predicts base_link, for everyone who asks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from sample_models import make_model, named

from slipwise import _core
from slipwise.export.actuator import actuator_of
from slipwise.export.c_header import c_header
from slipwise.export.reference_drive import motion_covariance, slip_density
from slipwise.models import Model, load_model
from slipwise.models.summary import summarise
from slipwise.planning import rollout
from slipwise.prediction import predict

MADE = replace(named("full-linear-6", lon__V=-0.1, ang__w=-0.3), commands=True, clock_offset=0.05)
COMMANDS = np.array([[0.0, 1.0, 0.3], [0.4, 0.5, -0.7], [1.1, 0.2, 0.9]])


@pytest.fixture
def body() -> Model:
    return make_model(MADE)


@pytest.fixture
def mounted() -> Model:
    return make_model(replace(MADE, sensor_extrinsics=(1.5, -0.2, 0.3)))


def test_the_file_keeps_the_mount(mounted: Model, tmp_path: Path) -> None:
    again = load_model(mounted.save(tmp_path / "m.yaml"))
    assert again.content == mounted.content
    assert again.motion.sensor_extrinsics
    assert [p.name for p in again.content.parameters][-3:] == ["sensor_x", "sensor_y", "sensor_yaw"]
    assert again.mean[-3:].tolist() == [1.5, -0.2, 0.3]


def test_a_file_from_before_there_was_a_mount_is_read(body: Model, tmp_path: Path) -> None:
    content = yaml.safe_load(body.to_yaml())
    del content["sensor_extrinsics"]
    path = tmp_path / "old.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    assert not load_model(path).motion.sensor_extrinsics


def test_the_body_is_the_model_without_the_mount_and_the_clock_of_its_sensor(mounted: Model) -> None:
    body = make_model(replace(MADE, clock_offset=None))
    assert mounted.body.content == body.content
    assert body.body is body


def test_prediction_is_that_of_base_link(body: Model, mounted: Model) -> None:
    ours, theirs = (predict(model, COMMANDS, horizon=3.0) for model in (mounted, body))
    np.testing.assert_array_equal(ours.poses, theirs.poses)
    np.testing.assert_array_equal(ours.covariance, theirs.covariance)


def test_the_core_compares_the_sensor(mounted: Model) -> None:
    history = _core.InputHistory(
        *(COMMANDS[:, [0]].T),
        *(np.ascontiguousarray(c) for c in (COMMANDS[:, 1], np.zeros(3), COMMANDS[:, 2])),
    )
    late = 0.05  # its clock: the poses of this segment are those of the path
    segment = _core.Segment(late, 3.0 + late, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)
    at = _core.linearize_segment(mounted.motion, mounted.mean, history, segment)
    sensor = _core.Pose2(1.5, -0.2, 0.3)
    end = _core.Pose2(*predict(mounted, COMMANDS, horizon=3.0).poses[-1].tolist())
    expected = _core.between(sensor, _core.compose(end, sensor))
    np.testing.assert_allclose(at.predicted.vector(), expected.vector(), atol=1e-12)


def test_rollouts_are_those_of_base_link(body: Model, mounted: Model) -> None:
    commands = np.tile(COMMANDS[:, 1:], (2, 4, 1))
    results = [rollout(model, commands, 0.1, covariance=True) for model in (mounted, body)]
    np.testing.assert_array_equal(results[0].path, results[1].path)
    np.testing.assert_allclose(results[0].covariance, results[1].covariance, rtol=1e-6, atol=1e-12)


def test_exports_are_those_of_base_link(body: Model, mounted: Model) -> None:
    ours, theirs = actuator_of(mounted), actuator_of(body)
    for channel in ("v", "omega"):
        a, b = getattr(ours, channel), getattr(theirs, channel)
        assert (a.mean_delay.value, a.gain.value) == (b.mean_delay.value, b.gain.value)
    assert c_header(mounted, ["origin"]) == c_header(body, ["origin"])
    for stated in (motion_covariance, slip_density):
        np.testing.assert_allclose(
            stated(mounted, (0.7, 0.3), 1.0), stated(body, (0.7, 0.3), 1.0), rtol=1e-12
        )


def test_delays_to_wheel_speeds_that_are_stamped_late_are_not_those_to_the_motion() -> None:
    late = make_model(replace(MADE, clock_offset=-0.12))
    assert late.parameters["delay_v"].value == pytest.approx(0.2)
    assert actuator_of(late).v.delay.value == pytest.approx(0.08)
    assert len(late.body.content.parameters) == len(late.content.parameters) - 1
    said = " ".join(summarise(late).sentences)
    assert "after 0.08" in said
    assert "Wheel speeds are stamped 0.120" in said
