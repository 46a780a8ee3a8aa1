# SPDX-License-Identifier: Apache-2.0
"""With the exported alphas AMCL's particles spread as the model predicts, by Monte Carlo."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from export.amcl_particles import spread
from numpy.typing import NDArray
from sample_models import make_model, named

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.export import ExportOptions, export_model
from slipwise.export.amcl import DEFAULT, UPDATE_ANGLE, UPDATE_DISTANCE, alphas
from slipwise.export.reference_drive import motion_covariance
from slipwise.models import Model

Floats = NDArray[np.float64]

HORIZON = 2.0  # s: 1 m and 0.8 rad at half of the fastest drive, four updates of AMCL by both
ROBOT = replace(named("edd-2", lon__V=-0.1, ang__w=-0.3), speed=(-0.5, 1.0), yaw_rate=(-0.8, 0.6))
WHITE = replace(ROBOT, fraction=0.0, std=0.0)
DRIVES = {"straight": (0.5, 0.0), "turn": (0.0, 0.4), "arc": (0.5, 0.4)}


def odometry(drive: tuple[float, float], seconds: float) -> Floats:
    """Return poses of a drive at AMCL's updates, [N, 3]."""
    v, omega = drive
    updates = round(max(v * seconds / UPDATE_DISTANCE, omega * seconds / UPDATE_ANGLE))
    step = _core.exp(np.array([v, 0.0, omega]) * seconds / updates)
    poses = [_core.Pose2(0.0, 0.0, 0.0)]
    for _ in range(updates):
        poses.append(_core.compose(poses[-1], step))
    return np.array([pose.vector() for pose in poses])


def std_ratios(model: Model, drive: str, *, omni: bool, seconds: float = HORIZON) -> Floats:
    """Return AMCL's standard deviations of (x, y, yaw) over the model's."""
    found = alphas(model, HORIZON)
    particles = spread(
        odometry(DRIVES[drive], seconds), found.omni if omni else found.differential, omni=omni
    )
    predicted = motion_covariance(model, DRIVES[drive], seconds)
    return np.sqrt(np.diag(particles) / np.diag(predicted))


def test_omnidirectional_particles_spread_as_predicted(subtests: pytest.Subtests) -> None:
    for made in [ROBOT, WHITE]:
        for drive, tolerance in [("straight", 0.02), ("turn", 0.02), ("arc", 0.14)]:
            with subtests.test(made=made, drive=drive, tolerance=tolerance):
                assert np.abs(std_ratios(make_model(made), drive, omni=True) - 1.0).max() < tolerance


@pytest.mark.parametrize("drive", DRIVES)
def test_white_noise_spreads_as_predicted_over_twice_the_horizon(drive: str) -> None:
    ratios = std_ratios(make_model(WHITE), drive, omni=True, seconds=2.0 * HORIZON)
    assert np.abs(ratios - 1.0).max() < 0.17


@pytest.mark.parametrize("drive", DRIVES)
def test_differential_particles_spread_along_and_in_heading_about_as_predicted(drive: str) -> None:
    x, _, yaw = std_ratios(make_model(ROBOT), drive, omni=False)
    assert 1.0 / 1.4 < yaw < 1.4
    assert 1.0 / 1.6 < x < 1.6


def test_differential_particles_of_a_straight_drive_are_right_but_for_sideways() -> None:
    x, y, yaw = std_ratios(make_model(ROBOT), "straight", omni=False)
    assert abs(x - 1.0) < 0.02
    assert abs(yaw - 1.0) < 0.02
    assert y < 0.5


def test_alphas_are_covariance_over_distance_and_update() -> None:
    model = make_model(replace(WHITE, psd_motion=2e-3, scale=(1.0, 4.0, 9.0)))
    a1, a2, a3, _, _ = alphas(model, HORIZON).omni
    assert a3 == pytest.approx(2e-3 / UPDATE_DISTANCE)  # m^2/m over a distance: density over update
    assert a2 == pytest.approx(9.0 * 2e-3 / 5.0 / UPDATE_DISTANCE)  # 5 m disturb the heading like 1 rad
    assert a1 == pytest.approx(9.0 * 2e-3 / UPDATE_ANGLE)


def written(options: ExportOptions) -> dict[str, Any]:
    text = export_model(make_model(ROBOT), "amcl", name="m.yaml", options=options).text
    parameters: dict[str, Any] = yaml.safe_load(text)["amcl"]["ros__parameters"]
    return parameters


def test_file_holds_the_alphas_of_the_sample_model_of_the_robots_kind() -> None:
    asked = ExportOptions(horizon=HORIZON, small_alphas=True)
    found = alphas(make_model(ROBOT), HORIZON)
    one, omni = written(asked), written(replace(asked, omni=True))
    assert one["robot_model_type"] == "nav2_amcl::DifferentialMotionModel"
    assert [one[f"alpha{i}"] for i in range(1, 5)] == pytest.approx(found.differential[:4], rel=1e-5)
    assert "alpha5" not in one
    assert omni["robot_model_type"] == "nav2_amcl::OmniMotionModel"
    assert [omni[f"alpha{i}"] for i in range(1, 6)] == pytest.approx(found.omni, rel=1e-5)
    assert (omni["update_min_d"], omni["update_min_a"]) == (UPDATE_DISTANCE, UPDATE_ANGLE)


def test_alphas_below_amcls_default_are_left_and_the_file_says_why() -> None:
    file = export_model(make_model(ROBOT), "amcl", name="m", options=ExportOptions(horizon=HORIZON))
    found = alphas(make_model(ROBOT), HORIZON).differential[:4]
    for i, alpha in enumerate(found, start=1):
        assert (f"alpha{i}" in file.values) == (alpha >= DEFAULT)
    assert any("below AMCL's default of 0.2: --small-alphas" in why for why in file.kept.values())
    assert "# CAUTION: alphas far below AMCL's default" in file.text


def test_learned_growth_makes_the_alphas_grow() -> None:
    grown = make_model(replace(ROBOT, inflation={1.0: 2.0, 4.0: 8.0}))
    factor = np.exp(np.interp(HORIZON, [1.0, 4.0], np.log([2.0, 8.0])))
    assert alphas(grown, HORIZON).omni[:4] == pytest.approx(
        [factor * alpha for alpha in alphas(make_model(ROBOT), HORIZON).omni[:4]]
    )


def test_a_model_from_commands_is_refused() -> None:
    with pytest.raises(ModelError, match="noise of wheel odometry"):
        export_model(make_model(replace(ROBOT, commands=True)), "amcl", name="m.yaml")


def test_a_robot_that_never_turned_is_refused() -> None:
    with pytest.raises(ModelError, match="no speed or no yaw rate"):
        export_model(make_model(replace(ROBOT, yaw_rate=(0.0, 0.0))), "amcl", name="m.yaml")
