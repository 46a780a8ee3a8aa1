# SPDX-License-Identifier: Apache-2.0
"""The tyre law is a friction law: nothing at rest, bounded, symmetric, and never a source of energy."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from slipwise_sim.land_tamer import LandTamer, mjcf
from slipwise_sim.tyre_law import TyreForceTerrain, TyreLaw, tyre_force, tyre_forces

LAW = TyreLaw()
LOAD = np.full(1000, 1600.0)


def random_states() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.Generator(np.random.PCG64(7))
    return rng.uniform(-2, 2, (2, LOAD.size)), rng.uniform(-2, 2, LOAD.size)


def test_wheel_at_rest_feels_no_force() -> None:
    force = tyre_force(LAW, LOAD, np.zeros((2, LOAD.size)), np.zeros(LOAD.size))
    assert np.array_equal(force, np.zeros((2, LOAD.size)))


def test_freely_rolling_wheel_feels_rolling_resistance_alone() -> None:
    force = tyre_force(LAW, np.array([1000.0]), np.array([[2.0], [0.0]]), np.array([2.0]))
    assert force == pytest.approx(np.array([[-LAW.rolling_resistance * 1000.0], [0.0]]), rel=1e-9)


def test_small_slip_gives_the_stated_stiffness() -> None:
    speed, slip = 2.0, 1e-5
    load = np.array([1000.0])
    law = TyreLaw(rolling_resistance=0.0)
    forward = tyre_force(law, load, np.array([[speed * (1 - slip)], [0.0]]), np.array([speed]))
    side = tyre_force(law, load, np.array([[speed], [speed * slip]]), np.array([speed]))
    assert forward[0, 0] == pytest.approx(law.friction * 1000.0 * law.slip_stiffness * slip, rel=1e-4)
    assert side[1, 0] == pytest.approx(-law.friction * 1000.0 * law.cornering_stiffness * slip, rel=1e-4)


def test_force_stays_within_the_friction_circle() -> None:
    law = TyreLaw(rolling_resistance=0.0)
    force = tyre_force(law, LOAD, *random_states())
    assert np.all(np.hypot(*force) <= law.friction * LOAD * (1 + 1e-12))
    assert np.hypot(*force).max() > 0.99 * law.friction * LOAD[0]


def test_ground_never_gives_energy() -> None:
    velocity, rim_speed = random_states()
    force = tyre_force(LAW, LOAD, velocity, rim_speed)
    sliding = velocity - np.stack([rim_speed, np.zeros_like(rim_speed)])
    resistance = -LAW.rolling_resistance * LOAD * np.tanh(velocity[0] / LAW.drag_speed)
    assert np.all(((force - [resistance, np.zeros_like(resistance)]) * sliding).sum(axis=0) <= 0)
    assert np.all(resistance * velocity[0] <= 0)


def test_unloaded_wheel_feels_no_force() -> None:
    assert not tyre_force(LAW, 0 * LOAD, *random_states()).any()


def test_forces_act_at_the_contact_patches() -> None:
    """The force on a locked, sliding wheel opposes the sliding; its arm about the hub is the radius."""
    vehicle = LandTamer()
    model = mujoco.MjModel.from_xml_string(mjcf(vehicle, time_step=0.002, friction=None))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1000)
    data.qvel[0] = 2.0
    mujoco.mj_step1(model, data)
    TyreForceTerrain(tyre_forces(LAW), vehicle, model, data).apply()
    wrench = data.xfrc_applied[model.body("wheel_l1").id]
    assert wrench[0] == pytest.approx(-(LAW.friction + LAW.rolling_resistance) * 1635.0, rel=1e-3)
    np.testing.assert_allclose(np.delete(wrench, [0, 4]), 0, atol=1.0)
    assert wrench[4] == pytest.approx(-vehicle.wheel_radius * wrench[0], rel=1e-9)
    assert not data.xfrc_applied[model.body("hull").id].any()


def test_yawing_hull_drags_the_outer_wheels_sideways() -> None:
    vehicle = LandTamer()
    model = mujoco.MjModel.from_xml_string(mjcf(vehicle, time_step=0.002, friction=None))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1000)
    data.qvel[5] = 1.0
    mujoco.mj_step1(model, data)
    TyreForceTerrain(tyre_forces(LAW), vehicle, model, data).apply()
    left_force = {name: data.xfrc_applied[model.body(f"wheel_{name}").id, 1] for name in ("l0", "l1", "l2")}
    assert left_force["l0"] < -500
    assert left_force["l2"] > 500
    assert abs(left_force["l1"]) < 1
