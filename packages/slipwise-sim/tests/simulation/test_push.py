# SPDX-License-Identifier: Apache-2.0
"""Pushes of a simulated vehicle do what forces do, and stuck wheels drag."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_sim.drive import hold
from slipwise_sim.land_tamer import LandTamer
from slipwise_sim.physics import Sampling, World, run_physics
from slipwise_sim.push import Push, StuckWheel
from slipwise_sim.truth import Truth
from slipwise_sim.tyre_law import TyreLaw

LAW = TyreLaw()


def driven(push: Push | None = None, stuck: StuckWheel | None = None) -> Truth:
    pytest.importorskip("mujoco")
    world = World(LandTamer(), "tyre-force", LAW, push=push, stuck=stuck)
    return run_physics(world, hold(1.0, 0.0, 8.0), Sampling.over(8.0, 20.0))


def test_a_side_force_makes_the_side_slip_of_the_tyre_law() -> None:
    truth = driven(Push((0.0, 1000.0), frame="world"))
    late = truth.t > 5.0
    weight = 1000.0 * 9.81
    expected = 1000.0 / (LAW.cornering_stiffness * LAW.friction * weight)
    assert (truth.vy / truth.vx)[late].mean() == pytest.approx(expected, rel=0.1)


def test_a_push_ends_when_it_is_said_to() -> None:
    truth = driven(Push((0.0, 1000.0), start=3.0, end=5.0))
    assert np.abs(truth.vy[truth.t < 2.9]).max() < 1e-3
    assert truth.vy[(truth.t > 4.0) & (truth.t < 5.0)].mean() > 0.01
    assert np.abs(truth.vy[truth.t > 7.0]).max() < 2e-3


def test_a_stuck_wheel_slows_the_robot_and_turns_it_to_its_side() -> None:
    plain, stuck = driven(), driven(stuck=StuckWheel("l1"))
    late = plain.t > 5.0
    assert stuck.vx[late].mean() < plain.vx[late].mean() - 0.01
    assert stuck.omega[late].mean() > 0.005  # to the left
    assert stuck.wheel_left[late].mean() > 2.0  # its encoder sits in another wheel


def test_impossible_pushes_are_refused() -> None:
    with pytest.raises(SettingsError, match="beyond all forces"):
        Push((np.nan, 0.0))
    with pytest.raises(SettingsError, match="ends before"):
        Push(start=2.0, end=1.0)
    with pytest.raises(SettingsError, match="no wheel"):
        StuckWheel("x9").column(LandTamer())
