# SPDX-License-Identifier: Apache-2.0
"""Rovers go where their wheels say, less a slip that is known, and the slip of a log is recovered."""

from __future__ import annotations

import numpy as np
import pytest

import slipwise as sw
from slipwise import _core
from slipwise.calibration import make_settings
from slipwise.logs.log import Inputs
from slipwise_sim.rover import RoughGround, Rover, swerve_base
from slipwise_sim.rover_drive import (
    PERIOD,
    drive_rover,
    joint_targets,
    mean_twists,
    rover_commands,
    true_slip,
)

pytest.importorskip("mujoco")


def held(twist: tuple[float, float, float], seconds: float) -> Inputs:
    t = np.arange(0.0, seconds, PERIOD)
    return Inputs(t, *(np.full(len(t), value) for value in twist))


def test_commands_have_no_jumps_and_a_rover_is_not_told_to_go_sideways() -> None:
    commands = rover_commands(swerve_base(), 30.0, 1)
    assert np.abs(np.diff(commands.v)).max() < 0.026
    assert np.abs(commands.vy).max() > 0.1
    assert not rover_commands(Rover(), 30.0, 1).vy.any()


def test_a_rover_that_turns_steers_its_front_and_rear_wheels_against_each_other() -> None:
    targets = joint_targets(Rover(), held((0.3, 0.0, 0.4), 0.2))
    front_left, front_right, rear_left, rear_right = targets[-1, :4]
    assert front_left > front_right > 0.0
    assert (rear_left, rear_right) == pytest.approx((-front_left, -front_right))


@pytest.mark.parametrize(("rover", "twist"), [(Rover(), (0.3, 0.0, 0.3)), (swerve_base(), (0.2, -0.2, 0.2))])
def test_it_drives_as_its_wheels_tell_less_their_wear(
    rover: Rover, twist: tuple[float, float, float]
) -> None:
    drive = drive_rover(rover, held(twist, 3.0))
    found = drive.wheel_twists()
    assert [found.v[-2], found.vy[-2], found.omega[-2]] == pytest.approx(list(twist), abs=5e-3)
    told = [float(part[30:-1].mean()) for part in (found.v, found.vy, found.omega)]
    moved = mean_twists(drive.truth)[30:].mean(axis=0)
    assert moved == pytest.approx([0.9475 * part for part in told], abs=1e-3)  # 5 % smaller, and creep


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rover", "stones", "basis"),
    [(swerve_base(), 0, "omni-8"), (Rover(), 600, "full-linear-6")],
    ids=["swerve", "rocker-bogie on stones"],
)
def test_slip_is_recovered_within_three_sigma(rover: Rover, stones: int, basis: str) -> None:
    for seed in (1, 2):
        ground = RoughGround(stones, height=0.05, seed=seed)
        drive = drive_rover(rover, rover_commands(rover, 45.0, seed), ground)
        truth = true_slip(drive, _core.named_basis(basis))
        settings = make_settings({"basis": basis, "change": {"branches": False}})
        model = sw.calibrate(drive.log(seed=seed), input="wheel", settings=settings).model
        assert model["lon.V"].value < -0.045
        for name, true in truth.items():
            assert abs(model[name].value - true) < 3.0 * model[name].std, name
            assert model[name].std < 0.02, name


@pytest.mark.slow
def test_a_learned_rover_predicts_held_out_windows_better_than_its_stated_sizes() -> None:
    rover = Rover()
    drive = drive_rover(rover, rover_commands(rover, 45.0, 4), RoughGround(600, height=0.05, seed=4))
    options = sw.EvaluationOptions(horizons=(2.0,), methods=("none", "auto"))
    position = {
        s.method: s.position.mean for s in sw.evaluate(drive.log(), input="wheel", options=options).scores
    }
    assert position["auto"] < 0.6 * position["none"]
