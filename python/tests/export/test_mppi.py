# SPDX-License-Identifier: Apache-2.0
"""MPPI is told how late the robot answers and how fast it may go, under the names of two Nav2 versions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml
from sample_models import BODY, Made, make_model, named

from slipwise import _core
from slipwise.errors import ModelError
from slipwise.export import ExportOptions, export_model
from slipwise.models import Model
from slipwise.prediction import predict

LATE = replace(
    named(
        "edd-2",
        lon__V=-0.1,
        ang__w=-0.4,
        log_time_constant_omega=float(np.log(0.5)),
        log_delay_v=float(np.log(0.1)),
    ),
    commands=True,
)
NEW = ExportOptions(ros_distro="rolling")
KILTED = ExportOptions(ros_distro="kilted", limits=True)
BODY_SPEED, BODY_TURN = 1.35, 0.7


def written(made: Made, options: ExportOptions | None = None) -> dict[str, Any]:
    text = export_model(make_model(made), "mppi", name="model.yaml", options=options or NEW).text
    parameters: dict[str, Any] = yaml.safe_load(text)["controller_server"]["ros__parameters"]["FollowPath"]
    return parameters


def test_a_delay_that_is_not_known_is_not_handed_on_as_none() -> None:
    unknown = make_model(Made(_core.named_basis("edd-2"), delays=(-6e-16, 0.2), std=0.2))
    made = export_model(unknown, "mppi", name="model.yaml", options=NEW)
    assert "too uncertain" in made.kept["FollowPath.model_delay_vx"]
    filtered = export_model(unknown, "robot-localization", name="model.yaml", options=NEW)
    assert not any("acceleration_gains" in name for name in filtered.values)


def test_delays_are_delay_plus_lag() -> None:
    parameters = written(LATE)
    assert parameters["model_delay_vx"] == pytest.approx(0.1 + 0.3)
    assert parameters["model_delay_wz"] == pytest.approx(0.2 + 0.5)


def test_the_delay_loses_the_distance_that_lag_and_delay_lose() -> None:
    model = make_model(LATE)
    path = predict(model, [(0.0, 1.0, 0.0)], horizon=8.0, initial=(0.0, 0.0))
    lost = 0.9 * 8.0 - path.poses[-1, 0]  # 0.9 of the commanded speed is reached
    assert lost == pytest.approx(0.9 * written(LATE)["model_delay_vx"], rel=1e-3)


def test_learned_limits_of_acceleration_replace_what_is_less_strict() -> None:
    axes = {
        "speed": {"dead_band": 0.1, "saturation": 1.2, "slew_rate_up": 0.8, "slew_rate_down": 1.7},
        "yaw_rate": {"saturation": 5.0, "slew_rate_up": 0.3},
    }
    made = replace(named("edd-2"), commands=True, limits=axes)
    parameters, gains = written(made, KILTED), (1.1, 0.9)  # of the sides behind the limits
    free = written(replace(made, limits=None), KILTED)
    assert parameters["ax_max"] == pytest.approx(gains[0] * 0.8)
    assert parameters["ax_min"] == pytest.approx(free["ax_min"])
    assert parameters["az_max"] == pytest.approx(gains[1] * 0.3)
    assert parameters["VelocityDeadbandCritic"]["deadband_velocities"] == [0.1, 0.0, 0.0]


def test_gain_and_slow_part_count() -> None:
    made = replace(named("edd-2", ang__w=-0.4), response=True)
    model, parameters = make_model(made), written(made, replace(NEW, planning_horizon=4.0))
    assert parameters["model_delay_vx"] == pytest.approx(0.2 + 0.7 * 0.3 + 0.3 * 1.5)
    path = predict(model, [(-60.0, 0.0, 0.0), (0.0, 1.0, 0.0)], horizon=20.0, start=0.0)
    lost = 0.9 * 20.0 - path.poses[-1, 0]
    assert lost == pytest.approx(0.9 * parameters["model_delay_vx"], rel=1e-3)


def test_the_delay_is_nearer_to_lag_and_delay_than_nothing_is() -> None:
    rng = np.random.default_rng(2)
    model, total = make_model(LATE), written(LATE)["model_delay_vx"]
    late = LATE.values | {"log_time_constant_v": -20.0, "log_delay_v": float(np.log(total))}
    at_once = LATE.values | {"log_time_constant_v": -20.0, "log_delay_v": -20.0}
    others = [make_model(replace(LATE, values=values)) for values in (late, at_once)]
    misses = []
    for _ in range(10):
        v = rng.uniform(-0.5, 1.5, 9)
        commands = np.column_stack((np.arange(9) * 0.35 - 0.7, v, np.zeros(9)))
        true, *stand_ins = (
            predict(m, commands, horizon=2.8, start=0.0).poses[:, 0] for m in (model, *others)
        )
        misses.append([np.abs(path - true).max() for path in stand_ins])
    delayed, plain = np.mean(misses, axis=0)
    assert delayed < 0.6 * plain


def test_the_ramp_loses_the_distance_that_lag_and_delay_lose() -> None:
    parameters = written(LATE, KILTED)
    fastest, turn = BODY_SPEED, BODY_TURN
    assert fastest**2 / (2.0 * parameters["ax_max"]) == pytest.approx(fastest * 0.4, rel=1e-5)
    assert turn**2 / (2.0 * parameters["az_max"]) == pytest.approx(turn * 0.7, rel=1e-5)
    assert parameters["ax_min"] == -parameters["ax_max"]


def test_limits_are_written_where_they_are_asked_for_alone_and_are_what_the_poses_show() -> None:
    parameters = written(LATE, replace(NEW, limits=True))
    assert (parameters["vx_max"], parameters["vx_min"], parameters["wz_max"]) == (1.35, -0.45, 0.7)
    assert not {"vx_max", "vx_min", "wz_max", "ax_max", "ax_min", "az_max"} & written(LATE).keys()
    assert written(LATE, replace(KILTED, limits=False)) == {"motion_model": "DiffDrive"}
    text = export_model(make_model(LATE), "mppi", name="m", options=replace(NEW, limits=True)).text
    for command in ("1.5", "-0.5", "1.17"):  # the body does 0.9 of the speed and 0.6 of the yaw rate
        assert f"a command of {command} gives it: write that where the drive is not corrected" in text
    older = export_model(make_model(replace(LATE, body=None)), "mppi", name="m", options=KILTED)
    assert "calibrate again" in older.kept["FollowPath.wz_max"]


#: A drive with a dead band, fitted by a lag of seconds.
SLOW = replace(LATE, values=LATE.values | {"log_time_constant_omega": float(np.log(3.0))})


def test_a_lag_that_was_never_seen_to_its_end_takes_no_yaw_away() -> None:
    made = replace(SLOW, body={**BODY, "held": [5.0, 2.0]})
    for options in (NEW, KILTED):
        file = export_model(make_model(made), "mppi", name="m", options=options)
        assert not {name for name in file.values if name.endswith(("model_delay_wz", "az_max"))}
    late = export_model(make_model(made), "mppi", name="m", options=NEW)
    assert "longer than commands were held in the log (2 s)" in late.kept["FollowPath.model_delay_wz"]
    assert "# a lag of 3 s was learned" in late.text
    old = export_model(make_model(made), "mppi", name="m", options=KILTED)
    assert "a lag of 3 s was learned" in old.kept["FollowPath.az_max"]
    assert old.kept["FollowPath.model_delay_wz"] == "ROS 2 Kilted has no such parameter"


def test_no_delay_is_written_that_leaves_the_controller_nothing_to_decide() -> None:
    file = export_model(make_model(SLOW), "mppi", name="m", options=NEW)
    assert "more than a quarter of the 2.8 s" in file.kept["FollowPath.model_delay_wz"]
    longer = replace(NEW, planning_horizon=14.0)
    assert written(SLOW, longer)["model_delay_wz"] == pytest.approx(3.2)


def test_no_ramp_is_below_what_the_poses_show() -> None:
    body = {**BODY, "yaw_acceleration": [0.9, 0.9], "acceleration": [0.1, 9.0]}
    file = export_model(make_model(replace(LATE, body=body)), "mppi", name="m", options=KILTED)
    assert "FollowPath.ax_max" in file.values
    assert "is below 0.9, which the poses show" in file.kept["FollowPath.az_max"]
    assert "is below 9, which the poses show" in file.kept["FollowPath.ax_min"]


def test_names_are_those_of_the_release_asked_for() -> None:
    for distro in ("lyrical", "rolling"):
        new = written(LATE, ExportOptions(ros_distro=distro))
        assert new["motion_model"] == "diff_drive"
        assert new["diff_drive"] == {"plugin": "mppi::DiffDriveMotionModel"}
        assert "model_delay_wz" in new
    for distro in ("humble", "jazzy", "kilted"):
        old = written(LATE, ExportOptions(ros_distro=distro))
        assert old["motion_model"] == "DiffDrive"
        assert not any(name.startswith("model_delay") for name in old)


def test_no_release_is_guessed() -> None:
    with pytest.raises(ModelError, match=r"differ between ROS releases: add --ros-distro humble or"):
        written(LATE, ExportOptions())
    with pytest.raises(ModelError, match="no table of parameters for ROS 'foxy'"):
        written(LATE, ExportOptions(ros_distro="foxy"))


@pytest.mark.parametrize(
    ("options", "place", "kind"),
    [
        (replace(NEW, min_turning_radius=0.8), "ackermann", "ackermann"),
        (replace(KILTED, min_turning_radius=0.8), "AckermannConstraints", "Ackermann"),
    ],
)
def test_smallest_turning_radius_is_widened_by_slip(options: ExportOptions, place: str, kind: str) -> None:
    parameters = written(LATE, options)
    assert parameters["motion_model"] == kind
    assert parameters[place]["min_turning_r"] == pytest.approx(0.8 * 0.9 / 0.6)


def test_smallest_turning_radius_is_asked_at_speeds_of_the_log() -> None:
    basis = _core.Basis("understeer", [], [], ["V*V*w"])
    made = Made(basis, {"ang.V^2*w": -0.2}, commands=True, speed=(0.0, 20.0), yaw_rate=(-1.0, 1.0))
    radius = written(made, replace(NEW, min_turning_radius=1.0))["ackermann"]["min_turning_r"]
    assert 1.0 < radius < 1.3  # the log never turned faster than 1 rad/s, so no faster than 1 m/s at 1 m


def test_comment_says_what_the_robot_reaches_of_a_command() -> None:
    text = export_model(make_model(LATE), "mppi", name="model.yaml", options=NEW).text
    assert "reaches 0.900 of the speed" in text
    assert "and 0.600 of the yaw rate" in text


def test_a_model_without_an_actuator_model_is_late_by_its_delay() -> None:
    made = replace(LATE, commands=False, values={}, delays=(0.2, -0.01))
    parameters = written(made)
    assert parameters["model_delay_vx"] == pytest.approx(0.2)
    assert parameters["model_delay_wz"] == 0.0


def test_a_model_from_wheel_speeds_is_refused() -> None:
    with pytest.raises(ModelError, match="not learned from commands"):
        written(replace(LATE, commands=False, values={}))


def test_a_vehicle_that_does_not_turn_as_steered_is_refused() -> None:
    with pytest.raises(ModelError, match="does not turn the way it is steered"):
        written(replace(LATE, values={"ang.w": -1.1}), replace(NEW, min_turning_radius=0.8))


def test_a_robot_that_steers_is_no_diff_drive() -> None:
    car, wheels = make_model(replace(LATE, wheelbase=0.5)), make_model(named("edd-2"))
    of_both = Model(car.content.model_copy(update={"other_input": wheels.content}))
    for each in (car, of_both):
        with pytest.raises(ModelError, match="no diff_drive_controller"):
            export_model(each, "diff-drive", name="model.yaml", options=NEW)
    made = export_model(car, "mppi", name="model.yaml", options=NEW)
    assert made.values["FollowPath.motion_model"] == "ackermann"
