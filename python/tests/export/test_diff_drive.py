# SPDX-License-Identifier: Apache-2.0
"""The multipliers of diff_drive_controller undo the learned slip, and its covariances are the model's."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from sample_logs import Drive, simulated_log
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.errors import ModelError, SettingsError
from slipwise.export import ExportOptions, export_model
from slipwise.export.diff_drive import PUBLISH_RATE
from slipwise.export.learned_number import LearnedNumbers
from slipwise.export.wheel_multipliers import wheel_multipliers
from slipwise.models import Model

EDD_2 = named("edd-2", lon__V=-0.08, ang__w=-0.5)
SEPARATION = 0.48
JAZZY = ExportOptions(ros_distro="jazzy")


def written(model: Model, options: ExportOptions | None = None) -> dict[str, Any]:
    text = export_model(model, "diff-drive", name="model.yaml", options=options or JAZZY).text
    parameters: dict[str, Any] = yaml.safe_load(text)["diff_drive_controller"]["ros__parameters"]
    return parameters


def test_edd_2_maps_exactly() -> None:
    parameters = written(make_model(EDD_2))
    assert parameters["left_wheel_radius_multiplier"] == pytest.approx(0.92, rel=1e-5)
    assert parameters["right_wheel_radius_multiplier"] == pytest.approx(0.92, rel=1e-5)
    assert parameters["wheel_separation_multiplier"] == pytest.approx(0.92 / 0.5, rel=1e-5)
    found = wheel_multipliers(make_model(EDD_2), ExportOptions())
    assert found.residual == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_multipliers_undo_slip() -> None:
    """Wheels that the controller drives with its multipliers give the body the twist that was asked for."""
    radius, (v, omega) = 0.16, (0.7, 0.4)
    found = wheel_multipliers(make_model(EDD_2), ExportOptions())
    half = omega * SEPARATION * found.separation.value / 2.0
    left = (v - half) / (radius * found.left_radius.value)
    right = (v + half) / (radius * found.right_radius.value)
    seen_v, seen_omega = radius * (left + right) / 2.0, radius * (right - left) / SEPARATION  # (2.2)
    state = _core.SlipState(seen_v, seen_omega, 0.0, 0.0)
    slip = _core.slip_rate(_core.named_basis("edd-2"), np.array([-0.08, -0.5]), state)
    assert (seen_v + slip[0], seen_omega + slip[2]) == pytest.approx((v, omega))


def test_unequal_radii_are_told_apart_with_a_separation() -> None:
    """A robot with wheels of known radii veers by a slip ang.V that gives the radii back."""
    left, right, multiplier = 0.95, 0.90, 1.6
    turn_per_speed = (right - left) / (SEPARATION * multiplier)
    turn_per_turn = (right + left) / (2.0 * multiplier)
    forward_per_turn = (right - left) * SEPARATION / 4.0
    values = {
        "lon.V": (left + right) / 2.0 - 1.0,
        "lon.w": forward_per_turn,
        "ang.V": turn_per_speed,
        "ang.w": turn_per_turn - 1.0,
    }
    made = Made(_core.named_basis("full-linear-6"), values, speed=(-1.0, 1.0), yaw_rate=(-1.0, 1.0))
    parameters = written(make_model(made), replace(JAZZY, wheel_separation=SEPARATION))
    assert parameters["wheel_separation"] == SEPARATION
    assert parameters["left_wheel_radius_multiplier"] == pytest.approx(left, rel=1e-5)
    assert parameters["right_wheel_radius_multiplier"] == pytest.approx(right, rel=1e-5)
    assert parameters["wheel_separation_multiplier"] == pytest.approx(multiplier, rel=1e-5)


def test_a_richer_model_maps_by_least_squares_over_its_range_and_says_what_is_left() -> None:
    made = named("odd-even-10", lon__V=-0.05, lat__w=0.07, ang__w=-0.4)
    made = replace(made, values={**made.values, "lon.V*abs(w)": 0.02, "ang.w*abs(w)": -0.1})
    model = make_model(made)
    v, w = np.meshgrid(np.linspace(*made.speed, 21), np.linspace(*made.yaw_rate, 21))
    forward, turn = 0.95 * v + 0.02 * v * np.abs(w), 0.6 * w - 0.1 * w * np.abs(w)
    g, h = np.sum(v * forward) / np.sum(v * v), np.sum(w * turn) / np.sum(w * w)
    found = wheel_multipliers(model, ExportOptions())
    assert (found.left_radius.value, found.separation.value) == pytest.approx((g, g / h))
    left = [np.sqrt(np.mean(np.square(part))) for part in (forward - g * v, 0.07 * w, turn - h * w)]
    assert found.residual == pytest.approx(left)
    text = export_model(model, "diff-drive", name="model.yaml", options=JAZZY).text
    assert f"forward {left[0]:.2g} m/s, sideways {left[1]:.2g} m/s, yaw {left[2]:.2g} rad/s" in text


def test_multipliers_in_force_while_logging_are_multiplied() -> None:
    options = replace(JAZZY, logged_separation_multiplier=1.875, logged_radius_multiplier=1.1)
    parameters = written(make_model(named("edd-2", ang__w=-0.2)), options)
    assert parameters["wheel_separation_multiplier"] == pytest.approx(1.875 / 0.8, rel=1e-5)
    assert parameters["left_wheel_radius_multiplier"] == pytest.approx(1.1, rel=1e-5)


def test_stated_sigma_is_that_of_drawn_parameters() -> None:
    model = make_model(replace(named("odd-even-10", lon__V=-0.1, ang__w=-0.4), std=0.003))
    rng = np.random.default_rng(4)
    names, drawn = [parameter.name for parameter in model.content.parameters], []
    for _ in range(60):
        values = dict(zip(names, rng.normal(model.mean, 0.003).tolist(), strict=True))
        other = make_model(Made(_core.named_basis("odd-even-10"), values))
        drawn.append(wheel_multipliers(other, ExportOptions()).separation.value)
    reported = LearnedNumbers(model).std(wheel_multipliers(model, ExportOptions()).separation)
    assert np.std(drawn) == pytest.approx(reported, rel=0.3)


def test_a_perfect_robot_has_multipliers_of_one_within_three_sigma() -> None:
    log = simulated_log(Drive(seconds=90.0, slip_psd=(1e-5, 1e-5, 1e-5)))
    model = calibrate(log, input="wheel", settings=make_settings({"basis": "odd-even-10"})).model
    found, numbers = wheel_multipliers(model, ExportOptions()), LearnedNumbers(model)
    for multiplier in (found.left_radius, found.separation):
        assert abs(multiplier.value - 1.0) < 3.0 * numbers.std(multiplier) < 0.1


def test_twist_covariance_gives_the_models_covariance_after_the_horizon() -> None:
    """Messages with this variance, each as new, spread as much after the horizon as `predict` says."""
    made = replace(EDD_2, speed=(-1.0, 1.0), yaw_rate=(-1.0, 1.0), inflation={1.0: 1.5}, fraction=0.1)
    parameters = written(make_model(made), replace(JAZZY, horizon=2.0))
    motion = np.array([0.5 + 0.3 * 0.5, 0.5 + 0.3 * 0.5, 0.5 + 0.5 / 5.0])  # derivations/uncertainty.md
    lasting = np.square(0.1 * motion) + np.square([0.01 * 0.5, 0.0, 0.01 * 0.5])  # slip, and parameters
    variance = 1.5 * (1e-3 * motion * 2.0 + lasting * 4.0)
    stated = np.array(parameters["twist_covariance_diagonal"])[[0, 1, 5]]
    assert stated / PUBLISH_RATE * 2.0 == pytest.approx(variance, rel=2e-3)
    assert parameters["publish_rate"] == PUBLISH_RATE
    assert parameters["pose_covariance_diagonal"][5] == pytest.approx(variance[2], rel=1e-5)
    assert all(value > 0.0 for value in parameters["pose_covariance_diagonal"])


def test_limits_are_written_where_they_are_asked_for_alone_and_are_what_the_poses_show() -> None:
    parameters = written(make_model(EDD_2), replace(JAZZY, limits=True))
    assert parameters["linear.x.max_velocity"] == 1.35
    assert parameters["linear.x.min_velocity"] == -0.45
    assert parameters["angular.z.max_velocity"] == 0.7
    assert parameters["angular.z.min_velocity"] == -0.7
    assert not any("velocity" in name for name in written(make_model(EDD_2)))
    humble = written(make_model(EDD_2), ExportOptions(ros_distro="humble", limits=True))
    assert humble["linear.x.has_velocity_limits"] is True


def test_the_twists_covariance_is_for_the_rate_at_which_odometry_comes() -> None:
    model = make_model(EDD_2)
    old = written(model)["twist_covariance_diagonal"]
    new = written(model, ExportOptions(ros_distro="lyrical", update_rate=500.0))
    assert "publish_rate" not in new
    assert new["twist_covariance_diagonal"][0] == pytest.approx(10.0 * old[0], rel=1e-4)
    unknown = export_model(model, "diff-drive", name="m", options=ExportOptions(ros_distro="lyrical"))
    assert "give --update-rate" in unknown.kept["twist_covariance_diagonal"]


REFUSED = {
    "from commands": (replace(EDD_2, commands=True), None, "need a model learned from wheel speeds"),
    "Ackermann": (EDD_2, replace(JAZZY, min_turning_radius=0.8), "smallest turning radius has no diff_drive"),
    "turns the other way": (named("edd-2", ang__w=-1.5), None, "turn it by -0.5"),
    "never drove": (replace(EDD_2, speed=(0.0, 0.0)), None, "move the robot by a factor of 0,"),
}


@pytest.mark.parametrize(("made", "options", "message"), REFUSED.values(), ids=REFUSED)
def test_what_does_not_fit_is_refused(made: Made, options: ExportOptions | None, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        written(make_model(made), options)


def test_impossible_options_are_refused(subtests: pytest.Subtests) -> None:
    for wrong in [
        {"horizon": 0.0},
        {"horizon": float("nan")},
        {"wheel_separation": -0.5},
        {"logged_separation_multiplier": float("inf")},
        {"min_turning_radius": 0.0},
        {"update_rate": 0.0},
    ]:
        with subtests.test(wrong=wrong), pytest.raises(SettingsError):
            ExportOptions(**wrong)
