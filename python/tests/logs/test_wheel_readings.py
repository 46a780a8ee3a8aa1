# SPDX-License-Identifier: Apache-2.0
"""Twists from the readings of all wheels, out of tables and joint states."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from sample_bags import EPOCH, SECOND, Bag, drive_along_x

from slipwise.errors import LogError
from slipwise.live.ros_samples import to_wheels
from slipwise.logs import LogOptions, open_log
from slipwise.logs.log import Floats
from slipwise.logs.messages import JOINT_STATE
from slipwise.logs.vehicle_description import VehicleDescription, load_vehicle
from slipwise.logs.wheel_readings import JointReadings, twists_of_wheels, wheel_names

SWERVE = """vehicle:
  wheels:
    - {name: fl, x: 0.4, y: 0.3, radius: 0.1, steer: fl_angle}
    - {name: fr, x: 0.4, y: -0.3, radius: 0.1, steer: fr_angle}
    - {name: rl, x: -0.4, y: 0.3, radius: 0.1, steer: rl_angle}
    - {name: rr, x: -0.4, y: -0.3, radius: 0.1, steer: rr_angle}
"""
TWISTS = np.array([[0.5, 0.1, 0.2], [0.6, 0.0, -0.4], [0.4, 0.2, 0.1]])


def swerve_table(folder: Path) -> tuple[Path, str]:
    vehicle = folder / "swerve.yaml"
    vehicle.write_text(SWERVE)
    layout = load_vehicle(str(vehicle)).layout
    assert layout is not None
    twists = np.repeat(TWISTS, 40, axis=0)
    speed, steering = layout.wheels_for(twists)
    t = 0.05 * np.arange(len(twists))
    names = ("fl", "fr", "rl", "rr")
    columns = {"t": t, "x": 0.4 * t, "y": 0.1 * t, "yaw": 0.0 * t}
    columns |= {f"wheel_{name}": speed[:, k] for k, name in enumerate(names)}
    columns |= {f"steer_{name}_angle": steering[:, k] for k, name in enumerate(names)}
    path = folder / "swerve.csv"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, fmt="%.9f", delimiter=",", header=",".join(columns), comments="")
    return path, str(vehicle)


def test_a_table_of_steered_wheels_gives_the_twist_that_drove_them(tmp_path: Path) -> None:
    path, vehicle = swerve_table(tmp_path)
    log = open_log(path, options=LogOptions(vehicle=vehicle))
    wheels = log.runs[0].wheels
    assert wheels is not None
    np.testing.assert_allclose(
        np.stack([wheels.v, wheels.vy, wheels.omega], 1), np.repeat(TWISTS, 40, 0), atol=1e-6
    )
    assert any("odo from the wheels of" in note for note in log.notes)


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    path, vehicle = swerve_table(tmp_path)
    path.write_text(path.read_text().replace("wheel_rl", "other"))
    with pytest.raises(LogError, match="wheel_rl"):
        open_log(path, options=LogOptions(vehicle=vehicle))


def test_a_row_without_a_reading_has_no_twist() -> None:
    vehicle = load_vehicle("robotino")
    names = wheel_names(vehicle, ["wheel0", "wheel1", "wheel2"])
    speed = np.array([[-5.0, 0.0, 5.0], [np.nan, 0.0, 5.0]])
    found = twists_of_wheels(vehicle, names, {f"wheel{k}": speed[:, k] for k in range(3)}, np.arange(2.0))
    assert np.isfinite(found.v).tolist() == [True, False]
    assert found.v[0] > 0.0
    assert np.isnan(found.contradiction)  # three wheels tell three numbers, and nothing more


def test_joint_states_are_read_by_the_names_of_wheels_live_too() -> None:
    options = LogOptions(vehicle="dingo-omni")
    vehicle = load_vehicle("dingo-omni")
    layout = vehicle.layout
    assert layout is not None
    speed, _ = layout.wheels_for(np.array([[0.3, 0.2, 0.5]]))
    names = [wheel.name for wheel in vehicle.wheels]
    joints = SimpleNamespace(
        name=["camera", *names], velocity=[9.0, *speed[0]], position=[0.0] * 5, header=None
    )
    assert JointReadings(vehicle)(joints) == pytest.approx(tuple(speed[0]))
    wheels = to_wheels(JOINT_STATE, options)(joints, 1.0)
    assert wheels is not None
    assert (wheels.v, wheels.vy, wheels.omega) == pytest.approx((0.3, 0.2, 0.5))


def test_a_joint_state_without_a_wheel_is_refused() -> None:
    read = JointReadings(load_vehicle("dingo-omni"))
    assert np.isnan(read(SimpleNamespace(name=["a"], velocity=[1.0], position=[0.0]))).all()
    with pytest.raises(LogError, match="front_left_wheel_joint"):
        read.refuse_none()
    some = SimpleNamespace(name=["front_left_wheel_joint"], velocity=[1.0], position=[0.0])
    with pytest.raises(LogError, match="front_right_wheel_joint"):
        read(some)


ARTICULATED = """vehicle:
  hinge: {name: waist, x: -1.0}
  wheels:
    - {name: fl, x: 0, y: 0.5, radius: 0.5}
    - {name: fr, x: 0, y: -0.5, radius: 0.5}
    - {name: rl, x: -3, y: 0.5, radius: 0.5, behind_hinge: true}
    - {name: rr, x: -3, y: -0.5, radius: 0.5, behind_hinge: true}
"""


def test_an_articulated_vehicle_in_a_bag_turns_as_its_hinge_says(tmp_path: Path) -> None:
    (tmp_path / "loader.yaml").write_text(ARTICULATED)
    angle, v = 0.3, 1.0
    omega = -v * np.sin(angle) / (np.cos(angle) + 2.0)  # Corke and Ridley 2001
    speeds = [(v - 0.5 * omega) / 0.5, (v + 0.5 * omega) / 0.5]
    at_hinge = np.array([v, -omega])  # velocity of the hinge in the front's frame
    along = float(at_hinge @ [np.cos(angle), np.sin(angle)])
    speeds += [(along - 0.5 * omega) / 0.5, (along + 0.5 * omega) / 0.5]
    bag = drive_along_x(Bag())
    for k in range(100):
        stamp = EPOCH + k * SECOND // 10
        names = ["fl", "fr", "rl", "rr", "waist"]
        bag.add(
            stamp, "/joint_states", JOINT_STATE, bag.joints(stamp, names, [0.0] * 4 + [angle], [*speeds, 0.0])
        )
    options = LogOptions(vehicle=str(tmp_path / "loader.yaml"))
    log = open_log(bag.write(tmp_path / "a.mcap"), options=options)
    wheels = log.runs[0].wheels
    assert wheels is not None
    np.testing.assert_allclose(wheels.v, v, atol=1e-9)
    np.testing.assert_allclose(wheels.vy, 0.0, atol=1e-9)
    np.testing.assert_allclose(wheels.omega, omega, atol=1e-9)


def readings_for(vehicle: VehicleDescription, twists: Floats) -> dict[str, Floats]:
    """What joints would read while a vehicle drives twists [N, 3] and its steering rests, by their names."""
    assert vehicle.layout is not None
    speed, steering = vehicle.layout.wheels_for(twists)
    found = {}
    for k, wheel in enumerate(vehicle.wheels):
        found["wheel_" + wheel.name] = speed[:, k] * (-1.0 if wheel.reversed else 1.0)
        if wheel.steer is not None:
            found["steer_" + wheel.steer] = steering[:, k] * (-1.0 if wheel.steer_reversed else 1.0)
    return found


@pytest.mark.parametrize(("preset", "vy"), [("pr2", 0.2), ("ranger-mini", 0.2), ("osr-rover", 0.0)])
def test_joint_states_of_steered_presets_tell_the_twist(preset: str, vy: float) -> None:
    vehicle = load_vehicle(preset)
    twist = np.array([[0.5, vy, 0.4]])
    readings = readings_for(vehicle, twist)
    names = ["arm", *(name.removeprefix("wheel_").removeprefix("steer_") for name in readings)]
    values = [3.0, *(float(value[0]) for value in readings.values())]
    joints = SimpleNamespace(name=names, velocity=values, position=values, header=None)
    wheels = to_wheels(JOINT_STATE, LogOptions(vehicle=preset))(joints, 1.0)
    assert wheels is not None
    assert (wheels.v, wheels.vy, wheels.omega) == pytest.approx(tuple(twist[0]), abs=1e-6)


def test_joints_may_be_named_as_columns_are() -> None:
    vehicle = VehicleDescription.model_validate(
        {
            "wheels": [
                {"name": n, "steer": n, "x": x, "y": y, "radius": 0.1}
                for n, x, y in (("f", 0.3, 0.0), ("l", -0.3, 0.2), ("r", -0.3, -0.2))
            ]
        }
    )
    read = JointReadings(vehicle)
    names = ["wheel_f", "steer_f", "steer_l", "wheel_l", "wheel_r", "steer_r"]
    message = SimpleNamespace(
        name=names, velocity=[1.0, 9.0, 9.0, 2.0, 3.0, 9.0], position=[0.1 * k for k in range(6)]
    )
    assert dict(zip(read.names.all, read(message), strict=True)) == pytest.approx(
        {"wheel_f": 1.0, "wheel_l": 2.0, "wheel_r": 3.0, "steer_f": 0.1, "steer_l": 0.2, "steer_r": 0.5}
    )
    with pytest.raises(LogError, match="speed and an angle at once"):
        wheel_names(vehicle, ["f", "l", "r"])


def test_casters_that_turn_do_not_tell_a_motion_of_the_body() -> None:
    """A PR2 at rest turns a caster: its two wheels roll against each other, as the rate of the joint says."""
    vehicle = load_vehicle("pr2")
    readings = {name: np.zeros(50) for name in readings_for(vehicle, np.zeros((1, 3)))}
    t, rate = 0.02 * np.arange(50), 2.0
    readings["steer_fl_caster_rotation_joint"] = rate * t
    for side, sign in (("l", -1.0), ("r", 1.0)):
        readings[f"wheel_fl_caster_{side}_wheel_joint"] = np.full(50, sign * rate * 0.049 / 0.074792)
    found = twists_of_wheels(vehicle, wheel_names(vehicle, list(readings)), readings, t)
    for part in (found.v, found.vy, found.omega):
        np.testing.assert_allclose(part[1:], 0.0, atol=1e-9)
    assert found.contradiction < 0.3  # of the first row alone, which has no rate yet


@pytest.mark.parametrize("preset", ["ranger-mini", "osr-rover"])
@pytest.mark.parametrize("excess", [1.0, 4.0])
def test_the_twist_lies_within_its_covariance_also_where_wheels_slip_more_than_stated(
    preset: str, excess: float
) -> None:
    vehicle = load_vehicle(preset)
    layout = vehicle.layout
    assert layout is not None
    twist = np.repeat([[0.8, 0.0, 0.3]], 1500, axis=0)
    speed, steering = layout.wheels_for(twist)
    rng = np.random.default_rng(4)
    radius = np.array([wheel.radius for wheel in vehicle.wheels])
    steered = np.array([wheel.steer is not None for wheel in vehicle.wheels])
    along, across = rng.normal(0.0, 0.02 * excess, (2, *speed.shape))
    noisy = speed + along / radius
    turned = steering + np.where(steered, across / (speed * radius), 0.0)
    twists, covariances = layout.twists(noisy, turned, np.zeros((0, 2)), np.zeros((0, len(radius))))
    error = np.asarray(twists)[:, :3] - twist
    covariance = np.asarray(covariances).reshape(-1, 3, 3)
    nees = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error)
    # Where readings contradict each other more than stated, their own scatter is the measure: F, not chi2.
    bound = 7.815 if excess == 1.0 else 3.0 * {5: 5.409, 9: 3.863}[int(twists[0, 4])]  # 95 of 100 below
    assert 0.93 < np.mean(nees < bound) < (0.97 if excess > 1.0 else 1.0)
