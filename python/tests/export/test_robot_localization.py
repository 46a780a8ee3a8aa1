# SPDX-License-Identifier: Apache-2.0
"""robot_localization's process noise is the slip noise, and its control term the learned lag."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.export import ExportOptions, export_model
from slipwise.export.robot_localization import DEFAULTS

ROBOT = replace(named("edd-2", ang__w=-0.2), speed=(-0.4, 1.0), yaw_rate=(-0.8, 0.8))
LAGS = {"log_time_constant_v": float(np.log(0.4)), "log_time_constant_omega": float(np.log(0.25))}
COMMANDED = replace(ROBOT, commands=True, values=LAGS)
FREQUENCY = 30.0  # Hz, the filter's default


def written(made: Made, options: ExportOptions | None = None) -> dict[str, Any]:
    text = export_model(make_model(made), "robot-localization", name="model.yaml", options=options).text
    parameters: dict[str, Any] = yaml.safe_load(text)["ekf_filter_node"]["ros__parameters"]
    return parameters


def test_process_noise_spreads_the_filter_as_the_model_predicts() -> None:
    """The filter adds Q (v^2 + w^2) dt: at that drive the model's variance after the horizon."""
    made = replace(ROBOT, scale=(1.0, 1.0, 4.0))
    parameters = written(made, ExportOptions(horizon=2.0))
    noise = np.array(parameters["process_noise_covariance"]).reshape(15, 15)
    assert not (noise - np.diag(np.diag(noise))).any()
    assert parameters["dynamic_process_noise_covariance"] is True
    wheels, turn = 0.5 + 0.3 * 0.4, 0.4 + 0.5 / 5.0
    x = 1e-3 * wheels * 2.0 + ((0.05 * wheels) ** 2 + (0.01 * 0.5) ** 2) * 4.0
    yaw = 4.0 * (1e-3 * turn * 2.0 + (0.05 * turn) ** 2 * 4.0) + (0.01 * 0.4) ** 2 * 4.0
    squared = 0.5**2 + 0.4**2
    assert noise[0, 0] == noise[1, 1]
    assert noise[0, 0] * squared * 2.0 == pytest.approx(x, rel=2e-3)
    assert noise[5, 5] * squared * 2.0 == pytest.approx(yaw, rel=2e-3)


def test_what_is_not_learned_keeps_the_filters_defaults() -> None:
    diagonal = np.diag(np.array(written(ROBOT)["process_noise_covariance"]).reshape(15, 15))
    others = [i for i in range(15) if i not in {0, 1, 5}]
    assert diagonal[others].tolist() == [DEFAULTS[i] for i in others]


def test_gains_are_one_over_the_lag_and_nothing_clips_what_they_ask_for() -> None:
    parameters = written(COMMANDED)
    assert parameters["use_control"] is True
    assert parameters["control_config"] == [True, False, False, False, False, True]
    gains = parameters["acceleration_gains"]
    assert gains == pytest.approx([2.5, 0, 0, 0, 0, 4.0])
    assert parameters["deceleration_gains"] == gains
    span = make_model(COMMANDED).content.range
    steps = [max(high, 0.0) - min(low, 0.0) for low, high in (span.speed, span.yaw_rate)]
    for name in ("acceleration_limits", "deceleration_limits"):
        assert parameters[name] == pytest.approx([2.5 * steps[0], 0, 0, 0, 0, 4.0 * steps[1]], rel=1e-3)
    assert written(replace(COMMANDED, body=None)) == parameters


def test_whether_commands_are_stamped_is_said_by_somebody_or_left() -> None:
    assert "stamped_control" not in written(COMMANDED)
    for stamped in (True, False):
        assert written(COMMANDED, ExportOptions(stamped_commands=stamped))["stamped_control"] is stamped


def test_the_filters_control_term_follows_a_step_as_the_core_does() -> None:
    gain, dt, speed = written(COMMANDED)["acceleration_gains"][0], 1.0 / FREQUENCY, 0.0
    for _ in range(30):
        speed += gain * (1.0 - speed) * dt
    drive = _core.Basis("none", [], [], [])
    motion = _core.MotionModel(drive, True, False)
    history = _core.InputHistory(np.array([0.0]), np.array([1.0]), np.zeros(1), np.zeros(1))
    start, lag = 1.0, np.log([0.4, 0.25, 1e-9, 1e-9])
    ends = [
        _core.linearize_segment(
            motion,
            lag,
            history,
            _core.Segment(start, start + t, _core.Pose2(0, 0, 0), _core.BodyTwist(0, 0, 0), 0, 0),
        ).predicted.x
        for t in (0.99, 1.01)
    ]
    assert speed == pytest.approx((ends[1] - ends[0]) / 0.02, abs=0.01)


def test_a_gain_stays_below_the_filters_frequency() -> None:
    quick = replace(COMMANDED, values={"log_time_constant_v": float(np.log(1e-3))})
    assert written(quick)["acceleration_gains"][0] == FREQUENCY
    parameters = written(quick, ExportOptions(filter_rate=50.0))
    assert (parameters["frequency"], parameters["acceleration_gains"][0]) == (50.0, 50.0)


def test_without_an_actuator_model_the_filter_follows_as_fast_as_it_can() -> None:
    parameters = written(replace(ROBOT, delays=(0.2, 0.1)))
    assert parameters["use_control"] is True
    assert parameters["acceleration_gains"][0] == FREQUENCY


def test_it_is_said_how_much_of_a_command_is_reached() -> None:
    """The filter takes commands for reached."""
    slips = make_model(replace(COMMANDED, values={**LAGS, "ang.w": -0.2}))
    text = export_model(slips, "robot-localization", name="model.yaml").text
    assert "0.800 of the yaw rate" in text


def test_a_model_from_wheel_speeds_has_no_control_term() -> None:
    parameters = written(ROBOT)
    assert parameters["use_control"] is False
    assert not any("gain" in name or "limit" in name for name in parameters)
