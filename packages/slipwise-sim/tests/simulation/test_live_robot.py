# SPDX-License-Identifier: Apache-2.0
"""The live robot drives as the scripted one does under the same commands."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs
from slipwise_sim import LandTamer, LiveRobot, TyreLaw, World
from slipwise_sim.physics import Sampling, run_physics

pytest.importorskip("mujoco", reason="simulation needs MuJoCo")

WORLD = World(LandTamer(), "tyre-force", TyreLaw())
PERIOD = 0.05  # s


def test_the_live_robot_goes_where_the_scripted_one_goes() -> None:
    t = np.arange(60) * PERIOD
    v, omega = np.full(60, 1.0), 0.6 * np.sin(2.0 * t)
    truth = run_physics(WORLD, Inputs(t=t, v=v, vy=np.zeros(60), omega=omega), Sampling.over(3.0, 20.0))
    robot = LiveRobot(WORLD, period=PERIOD)
    states = [robot.tell(*command) for command in zip(v.tolist(), omega.tolist(), strict=True)]
    last = states[-1]
    assert last.t == pytest.approx(3.0)
    assert last.pose == pytest.approx((truth.x[-1], truth.y[-1], truth.yaw[-1]), abs=2e-3)
    assert last.drive[0] > 0.8


def test_a_robot_that_is_told_nothing_new_stands_still() -> None:
    robot = LiveRobot(WORLD, period=PERIOD)
    assert robot.state().pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    assert robot.tell(0.0, 0.0).pose == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)


def test_another_floor_changes_what_wheels_make_of_the_motion() -> None:
    robot = LiveRobot(WORLD, period=PERIOD)
    loss = []
    for law in (TyreLaw(), TyreLaw(slip_stiffness=7.0, cornering_stiffness=8.5)):
        robot.stand_on(law)
        states = [robot.tell(1.0, 0.5) for _ in range(160)][80:]
        turned = (states[-1].pose[2] - states[0].pose[2]) / (states[-1].t - states[0].t)
        loss.append(1.0 - turned / np.mean([state.drive[1] for state in states]))
    assert loss[0] == pytest.approx(0.39, abs=0.04)
    assert loss[1] == pytest.approx(0.57, abs=0.04)


def test_contact_friction_cannot_change() -> None:
    robot = LiveRobot(World(LandTamer(), "contact-friction", TyreLaw()), period=PERIOD)
    with pytest.raises(SettingsError, match="cannot change"):
        robot.stand_on(TyreLaw())


def test_wrong_use_is_refused() -> None:
    with pytest.raises(SettingsError, match="the period is 0"):
        LiveRobot(WORLD, period=0.0)
    with pytest.raises(SettingsError, match="the command is nan"):
        LiveRobot(WORLD, period=PERIOD).tell(float("nan"), 0.0)
