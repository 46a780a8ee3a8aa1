# SPDX-License-Identifier: Apache-2.0
"""The controller takes any motion, knows the robot's disc on a map, and refuses what makes no sense."""

from __future__ import annotations

import math

import numpy as np
import pytest
from planning.planning_samples import learned_model, walled_map
from sample_models import LIMITS, Made, make_model

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError, UnseenSpeed
from slipwise.ground import Grade
from slipwise.planning import (
    Controller,
    GridMap,
    MppiOptions,
    ReferencePath,
    baseline_motion,
    inflated,
    learned_motions,
    vendor_motion,
)
from slipwise.planning.mppi import LETHAL

QUICK = MppiOptions(rollouts=256, periods=30, period=0.1)


def straight() -> ReferencePath:
    return ReferencePath(np.array([[0.0, 0.0], [20.0, 0.0]]), 0.8)


def test_the_controller_steers_back_to_its_track() -> None:
    slow = make_model(Made(basis=_core.named_basis("edd-2"), values={"ang.w": -0.3}, response=True))
    limited = make_model(
        Made(basis=_core.named_basis("edd-2"), values={"ang.w": -0.3}, response=True, limits=LIMITS)
    )
    for motions in (
        [baseline_motion()],
        [vendor_motion(1.5)],
        learned_motions(learned_model(), samples=2),
        learned_motions(slow, samples=2),
        learned_motions(limited, samples=2),
    ):
        controller = Controller(motions, straight(), options=QUICK)
        left = [controller.command((1.0, 0.8, 0.0), (0.5, 0.0)) for _ in range(3)][-1]
        controller = Controller(motions, straight(), options=QUICK)
        right = [controller.command((1.0, -0.8, 0.0), (0.5, 0.0)) for _ in range(3)][-1]
        assert left[0] > 0.0
        assert left[1] < 0.0 < right[1]


def test_motions_are_exchanged_under_way() -> None:
    kept, other = (Controller([vendor_motion(1.5)], straight(), options=QUICK) for _ in range(2))
    at = ((1.0, 0.8, 0.0), (0.5, 0.0))
    assert kept.command(*at) == other.command(*at)
    other.adopt([vendor_motion(1.5)])
    assert kept.command(*at) == other.command(*at)
    other.adopt(learned_motions(learned_model()))
    assert kept.command(*at) != other.command(*at)
    with pytest.raises(SettingsError, match="at least one model"):
        other.adopt([])


def test_a_side_that_was_never_driven_is_warned_of_once() -> None:
    one_sided = make_model(Made(_core.named_basis("edd-2"), commands=True, yaw_rate=(0.0, 1.0)))
    controller = Controller(one_sided, straight(), options=QUICK)
    left_of_track = ((1.0, 1.5, 0.0), (0.5, 0.0))
    with pytest.warns(UnseenSpeed, match="yaw rate of -.* rad/s is far beyond the 0 rad/s") as caught:
        turns = [controller.command(*left_of_track)[1] for _ in range(10)]
    assert min(turns) < -0.2
    assert len(caught) == 1


def test_drawn_motions_differ_as_their_covariance_says_and_follow_the_seed() -> None:
    disturbed = make_model(Made(basis=_core.named_basis("edd-2"), commands=True, disturbance=(0.1, 0.3, 8.0)))
    for model in (learned_model(), disturbed):
        drawn = np.array([motion.parameters for motion in learned_motions(model, samples=400, seconds=2.0)])
        assert (drawn[0] == model.mean).all()
        spread = drawn[1:].std(axis=0) / np.sqrt(np.diag(model.covariance_over(2.0)))
        assert spread == pytest.approx(1.0, abs=0.2)
        again = np.array([motion.parameters for motion in learned_motions(model, samples=400, seconds=2.0)])
        assert (drawn == again).all()


def test_a_moving_robot_does_not_brake_at_the_first_cycle() -> None:
    reference = ReferencePath(np.array([[0.0, 0.0], [20.0, 0.0]]), 1.0)
    slow = make_model(Made(basis=_core.named_basis("edd-2"), response=True))
    for motions in ([baseline_motion()], learned_motions(slow)):
        for last in (None, (1.0, 0.0)):
            controller = Controller(motions, reference, options=QUICK)
            v, _ = controller.command((1.0, 0.0, 0.0), (1.0, 0.0), last=last)
            assert v > 0.97


def test_the_last_command_bounds_the_next() -> None:
    controller = Controller([baseline_motion()], straight(), options=QUICK)
    controller.command((1.0, 0.0, 0.0), (0.0, 0.0))
    v, omega = controller.command((1.0, 0.0, 0.0), (0.2, 0.0), last=(1.2, -0.5))
    change = QUICK.acceleration * QUICK.period, QUICK.yaw_acceleration * QUICK.period
    assert abs(v - 1.2) <= change[0] + 1e-6
    assert abs(omega + 0.5) <= change[1] + 1e-6
    with pytest.raises(SettingsError, match="the last command is not a finite"):
        controller.command((1.0, 0.0, 0.0), (0.2, 0.0), last=(math.nan, 0.0))


def test_what_lies_beyond_the_map_costs_as_an_obstacle_does() -> None:
    grid = GridMap(np.zeros((40, 60), dtype=bool), 0.1)
    cells = np.asarray(inflated(grid, 0.5).cells)
    assert cells[20, 2] == cells[2, 30] == LETHAL
    assert cells[20, 30] == 0.0


def test_a_start_in_an_obstacle_is_refused() -> None:
    obstacles = inflated(walled_map(), 0.3)
    reference = ReferencePath(np.array([[1.0, 2.0], [11.0, 2.0]]), 0.8)
    controller = Controller([baseline_motion()], reference, options=QUICK, obstacles=obstacles)
    controller.command((2.0, 2.0, 0.0), (0.0, 0.0))
    with pytest.raises(PlanningError, match="starts inside an obstacle"):
        controller.command((5.7, 2.0, 0.0), (0.0, 0.0))


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(SettingsError, match="at least one model"):
        Controller([], straight())
    with pytest.raises(SettingsError, match="positive number of seconds"):
        Controller([baseline_motion()], straight(), options=MppiOptions(period=0.0))
    with pytest.raises(SettingsError, match="2 rollouts"):
        Controller([baseline_motion()], straight(), options=MppiOptions(rollouts=0))
    with pytest.raises(SettingsError, match="radius and inflation"):
        inflated(walled_map(), math.nan)
    controller = Controller([baseline_motion()], straight(), options=QUICK)
    with pytest.raises(SettingsError, match="the robot's pose is not a pose"):
        controller.command((math.nan, 0.0, 0.0), (0.0, 0.0))
    with pytest.raises(SettingsError):
        controller.command((0.0, 0.0, 0.0), (math.nan, 0.0))


def test_on_a_slope_across_its_track_the_controller_steers_uphill() -> None:
    """The robot slides to the right, downhill; who does not know it steers straight on."""
    values = {"lat.gy": 0.1}
    model = make_model(Made(basis=_core.named_basis("ipem-13"), values=values, std=1e-3, commands=True))
    reference = ReferencePath(np.column_stack((np.linspace(0.0, 20.0, 201), np.zeros(201))), speed=1.0)
    turned = []
    for grade in (None, Grade(0.25, downhill=-math.pi / 2)):
        controller = Controller(learned_motions(model, grade=grade), reference)
        turned.append(np.mean([controller.command((2.0, 0.0, 0.0), (1.0, 0.0))[1] for _ in range(10)]))
    assert turned[1] > turned[0] + 0.05
