# SPDX-License-Identifier: Apache-2.0
"""The vehicle weighs what it should, stands on six wheels, and its kinematics is its own inverse."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from slipwise_sim.land_tamer import GRAVITY, LandTamer, mjcf, wheel_names


def settled(vehicle: LandTamer, *, friction: float | None) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(mjcf(vehicle, time_step=0.002, friction=friction))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1000)
    return model, data


def test_vehicle_weighs_1000_kg() -> None:
    model, _ = settled(LandTamer(), friction=None)
    assert model.body_mass.sum() == pytest.approx(1000.0, abs=1e-9)


@pytest.mark.parametrize("friction", [None, 0.7])
def test_wheels_carry_the_weight_in_equal_parts(friction: float | None) -> None:
    _, data = settled(LandTamer(), friction=friction)
    assert data.sensordata == pytest.approx(1000.0 * GRAVITY / 6, rel=1e-3)


def test_vehicle_stands_level_at_its_nominal_height() -> None:
    vehicle = LandTamer()
    _, data = settled(vehicle, friction=None)
    assert data.qpos[2] == pytest.approx(vehicle.wheel_radius + vehicle.ground_clearance, abs=2e-3)
    assert data.qpos[3:7] == pytest.approx([1, 0, 0, 0], abs=1e-6)


def test_left_wheels_come_before_right_wheels() -> None:
    vehicle = LandTamer()
    assert wheel_names(vehicle) == ("l0", "r0", "l1", "r1", "l2", "r2")
    assert vehicle.wheel_places.tolist()[:2] == [[0.85, 0.65], [0.85, -0.65]]


def test_turning_left_turns_the_right_wheels_faster() -> None:
    left, right = LandTamer().side_rates(np.array([1.0]), np.array([0.5])).T
    assert right > left > 0


def test_odometry_undoes_side_rates() -> None:
    v, omega = np.array([0.0, 1.5, -0.4]), np.array([0.8, -0.3, 0.0])
    vehicle = LandTamer(wheel_radius=0.27, wheel_separation=1.1)
    back_v, back_omega = vehicle.odometry(*vehicle.side_rates(v, omega).T)
    np.testing.assert_allclose(back_v, v, atol=1e-15)
    np.testing.assert_allclose(back_omega, omega, atol=1e-15)
