# SPDX-License-Identifier: Apache-2.0
"""A vehicle on a hillside: it stands as the plane does, slides downhill, and is seen from above."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.errors import SettingsError
from slipwise.ground import Grade
from slipwise.models import Model
from slipwise_sim import Perturbation, Scenario, simulate
from slipwise_sim.drive import hold
from slipwise_sim.hillside import axes_of, gravity_on, traverse_drive
from slipwise_sim.land_tamer import GRAVITY, LandTamer
from slipwise_sim.physics import Sampling, World, run_physics
from slipwise_sim.tyre_law import TyreLaw
from slipwise_thesis.surfaces import LeastSquaresSurface

ACROSS = Grade(slope=0.12, downhill=-np.pi / 2)


def test_the_plane_has_right_angles_and_gravity_leans_downhill_on_it() -> None:
    grade = Grade(slope=0.3, downhill=0.8)
    axes = axes_of(grade)
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.arccos(axes[2, 2]) == pytest.approx(0.3)
    leaning = axes @ np.array(gravity_on(grade))
    assert leaning == pytest.approx([0.0, 0.0, -GRAVITY], abs=1e-12)
    assert gravity_on(None) == (0.0, 0.0, -GRAVITY)


@pytest.mark.slow
def test_a_vehicle_slides_downhill_and_climbs_no_hill() -> None:
    world = World(LandTamer(), "tyre-force", TyreLaw(), grade=ACROSS)
    truth = run_physics(world, hold(1.0, 0.0, 12.0), Sampling.over(12.0, 20.0))
    late = truth.t > 4.0
    assert truth.vy[late].mean() < -0.005  # downhill is to its right
    assert truth.z is not None
    assert truth.roll is not None
    assert truth.z[-1] - truth.z[0] == pytest.approx(np.tan(0.12) * (truth.y[-1] - truth.y[0]), abs=0.01)
    assert truth.roll[late].mean() == pytest.approx(0.12, abs=0.03)


@pytest.mark.slow
def test_a_log_of_a_hillside_has_poses_in_space_and_a_level_one_has_none() -> None:
    hill = simulate(Scenario(duration=5.0, grade=ACROSS), seed=1).log.runs[0].poses
    level = simulate(Scenario(duration=5.0), seed=1).log.runs[0].poses
    assert all(isinstance(column, np.ndarray) for column in (hill.z, hill.roll, hill.pitch))
    assert [level.z, level.roll, level.pitch] == [None] * 3


def test_slip_surfaces_have_no_hillside() -> None:
    surface = LeastSquaresSurface(_core.named_basis("edd-2"))
    with pytest.raises(SettingsError, match="level ground"):
        simulate(Scenario(grade=ACROSS, perturbation=Perturbation(surface)), seed=1)


def downhill_slip(model: Model, hill: Grade, seed: int) -> tuple[float, float]:
    """Mean slip velocity downhill on a course, as it was and as the model says from the wheels [m/s]."""
    scenario = Scenario(duration=200.0, grade=hill, commands=traverse_drive(seed, 200.0))
    truth = simulate(scenario, seed=seed).truth
    v, omega = LandTamer().odometry(truth.wheel_left, truth.wheel_right)
    angle = hill.downhill - truth.yaw
    downhill = np.stack((np.cos(angle), np.sin(angle)))
    pull = GRAVITY * np.sin(hill.slope) * downhill
    alpha, basis = model.mean[: model.motion.slip_size], model.motion.basis
    states = [_core.SlipState(*row) for row in zip(v, omega, *pull, strict=True)]
    predicted = np.array([_core.slip_rate(basis, alpha, state)[:2] for state in states]).T
    moving = truth.t > 3.0
    found = ((slip * downhill).sum(axis=0)[moving].mean() for slip in ((truth.vx - v, truth.vy), predicted))
    was, said = (float(value) for value in found)
    return was, said


@pytest.mark.slow
def test_side_slip_downhill_is_predicted_to_a_tenth_on_other_hills() -> None:
    hill = Grade(np.radians(6.0), downhill=-1.2)
    course = Scenario(duration=300.0, grade=hill, commands=traverse_drive(1, 300.0))
    model = calibrate(simulate(course, seed=3).log, input="command").model
    held_out = model.content.verdict.held_out
    assert held_out is not None
    assert held_out.position < 0.1 * held_out.baseline_position
    for slope, downhill, seed in ((5.0, 0.4, 2), (8.0, 2.0, 4), (10.0, -2.0, 5)):
        was, said = downhill_slip(model, Grade(np.radians(slope), downhill), seed)
        assert said == pytest.approx(was, rel=0.1)
