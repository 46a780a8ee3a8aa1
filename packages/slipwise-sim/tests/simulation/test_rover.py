# SPDX-License-Identifier: Apache-2.0
"""Rovers stand on all wheels, weigh what they should, and keep them on the ground where it is rough."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from slipwise_sim.rover import RoughGround, Rover, rover_mjcf, swerve_base

mujoco = pytest.importorskip("mujoco")


def settled(rover: Rover, ground: RoughGround | None = None) -> tuple[Any, Any]:
    model = mujoco.MjModel.from_xml_string(rover_mjcf(rover, ground or RoughGround()))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=800)
    return model, data


def test_a_rover_has_six_wheels_and_steers_its_corners() -> None:
    wheels = Rover().description().wheels
    assert len(wheels) == 6
    assert [wheel.name for wheel in wheels if wheel.steer is None] == ["ml", "mr"]
    assert all(wheel.steer == wheel.name for wheel in swerve_base().description().wheels)


@pytest.mark.parametrize("rover", [Rover(), swerve_base()])
def test_it_stands_level_and_every_wheel_touches_the_ground(rover: Rover) -> None:
    _, data = settled(rover)
    assert data.ncon == len(rover.wheels)
    assert data.qpos[2] == pytest.approx(rover.height, abs=4e-3)
    assert np.abs(data.qpos[4:6]).max() < 2e-3


def test_a_stone_under_one_wheel_turns_the_rockers_against_each_other() -> None:
    rover = Rover()
    stone = '<geom type="sphere" size=".2" pos="0.267 0.184 -.16" contype="2" conaffinity="1"/>'
    text = rover_mjcf(rover, RoughGround()).replace("<worldbody>", f"<worldbody>{stone}")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1500)
    left, right = (float(data.qpos[model.joint(f"rocker_{side}").qposadr[0]]) for side in "lr")
    assert left < -0.02  # its front is up
    assert left == pytest.approx(-right, abs=2e-3)
    touched = {int(pair[k]) for pair in data.contact.geom for k in (0, 1)}
    assert sum(model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE for geom in touched) >= 6


def test_stones_lie_where_their_seed_says_and_stand_out_by_no_more_than_their_height() -> None:
    ground = RoughGround(stones=20, height=0.04, seed=3)
    model, _ = settled(Rover(), ground)
    balls = np.flatnonzero((model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE) & (model.geom_bodyid == 0))
    top = model.geom_pos[balls, 2] + model.geom_size[balls, 0]
    assert len(balls) == 20
    assert 0.0 < top.min() <= top.max() <= 0.04 + 1e-4
    assert ground.mjcf() == RoughGround(stones=20, height=0.04, seed=3).mjcf()
