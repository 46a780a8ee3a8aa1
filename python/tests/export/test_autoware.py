# SPDX-License-Identifier: Apache-2.0
"""Autoware gets the scale of the speed and the offset of the steering, in ROS's axes, where learned."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
import yaml
from sample_models import Made, make_model, named

from slipwise.errors import ModelError
from slipwise.export import ExportOptions, export_model

CAR = replace(named("full-linear-6", lon__V=-0.04), std=0.001)
BASE = ExportOptions(wheel_base=2.5)


def written(made: Made, options: ExportOptions = BASE) -> dict[str, Any]:
    text = export_model(make_model(made), "autoware", name="m.yaml", options=options).text
    values: dict[str, Any] = yaml.safe_load(text)["/**"]["ros__parameters"]
    return values


@pytest.mark.parametrize("veer", [0.02, -0.02])
def test_a_vehicle_that_turns_while_it_reports_straight_has_its_wheels_turned_so(veer: float) -> None:
    values = written(replace(CAR, values={"lon.V": -0.04, "ang.V": veer}))
    assert values["speed_scale_factor"] == pytest.approx(0.96)
    assert values["steering_offset"] == pytest.approx(math.atan(2.5 * veer / 0.96), rel=1e-5)


def test_the_offset_adds_to_the_one_in_force() -> None:
    made = replace(CAR, values={"ang.V": 0.02})
    options = replace(BASE, logged={"steering_offset": -0.01})
    assert written(made, options)["steering_offset"] == pytest.approx(math.atan(0.05) - 0.01, rel=1e-5)


def test_what_was_not_learned_is_left_out() -> None:
    made = export_model(make_model(replace(CAR, std=0.5)), "autoware", name="m.yaml", options=BASE)
    assert set(made.kept) == {"speed_scale_factor", "steering_offset"}
    assert yaml.safe_load(made.text) == {"/**": {"ros__parameters": {}}}
    assert set(written(named("edd-2", lon__V=-0.1))) == {"speed_scale_factor"}


def test_without_a_wheel_base_there_is_no_angle() -> None:
    made = replace(CAR, values={"ang.V": 0.02})
    assert "steering_offset" not in written(made, ExportOptions())


def test_a_model_from_commands_is_refused() -> None:
    with pytest.raises(ModelError, match="this model is from commands"):
        written(replace(CAR, commands=True))
