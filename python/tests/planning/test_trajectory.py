# SPDX-License-Identifier: Apache-2.0
"""Trajectories end at their goal as `predict` sees it, stay within limits, and fail with advice."""

from __future__ import annotations

import contextlib
import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from planning.planning_samples import LIMITS, learned_model, sliding
from sample_models import LIMITS as AXES
from sample_models import Made, make_model, named

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError, UnseenSpeed
from slipwise.ground import ElevationMap, Grade
from slipwise.models import Model
from slipwise.planning import (
    DriveState,
    Limits,
    Planner,
    TrajectoryOptions,
    limits_of,
    trajectory_to,
    uncertain_path,
)
from slipwise.planning.limits import ACCELERATION
from slipwise.planning.trajectory import placed, pose_text

OPTIONS = TrajectoryOptions(cruise=1.0, longest=8.0)


@pytest.fixture(scope="module")
def planner() -> Planner:
    return Planner(learned_model(), limits=LIMITS, options=OPTIONS)


def test_a_trajectory_ends_at_the_goal_as_the_model_predicts(planner: Planner) -> None:
    rng = np.random.Generator(np.random.PCG64(4))
    for _ in range(30):
        bearing = rng.uniform(-0.5, 0.5)
        x, y = 4.5 * np.cos(bearing), 4.5 * np.sin(bearing)
        goal = (float(x), float(y), float(2.0 * bearing + rng.uniform(-0.3, 0.3)))
        plan = planner.to(goal)
        path = uncertain_path(learned_model(), plan)
        assert path.poses[-1] == pytest.approx(goal, abs=2e-3)
        assert plan.poses[-1] == pytest.approx(path.poses[-1], abs=1e-6)
        assert path.t[-1] == pytest.approx(plan.duration)


def test_a_robot_that_rests_at_the_goal_stays() -> None:
    here = (2.0, -1.0, 0.5)
    for goal in (here, (2.0, -1.0, 0.5 + 2.0 * math.pi)):
        plan = trajectory_to(learned_model(), goal, start=here, limits=LIMITS)
        assert plan.duration == 0.0
        assert plan.commands.tolist() == [[0.0, 0.0, 0.0]]
        assert plan.poses.tolist() == [[*here]]
        assert uncertain_path(learned_model(), plan).end == pytest.approx((0.0, 0.0, 0.0))
    moving = DriveState(drive=(0.5, 0.0), commanded=(0.5, 0.0))
    with contextlib.suppress(PlanningError):
        assert trajectory_to(learned_model(), here, start=here, limits=LIMITS, state=moving).duration > 0.0


def test_a_trajectory_to_a_side_that_was_never_driven_is_warned_of() -> None:
    one_sided = make_model(replace(named("edd-2"), speed=(0.0, 1.0), yaw_rate=(0.0, 1.0)))
    with pytest.warns(UnseenSpeed, match="yaw rate of -.* rad/s is far beyond the 0 rad/s"):
        trajectory_to(one_sided, (2.0, -1.0, -1.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trajectory_to(one_sided, (2.0, 1.0, 1.0))


def test_on_a_hillside_a_trajectory_ends_at_the_goal_as_the_model_predicts_there() -> None:
    model, grade, start = sliding(), Grade(0.15, downhill=0.7), (1.0, 2.0, -1.2)
    planner = Planner(model, limits=LIMITS, options=OPTIONS, ground=grade)
    goal = (3.5, -1.2, -0.6)
    plan = planner.to(goal, start=start)
    path = uncertain_path(model, plan, ground=grade, at=start)
    assert placed(path.poses, start)[-1] == pytest.approx(goal, abs=2e-3)
    assert plan.poses[-1] == pytest.approx(goal, abs=2e-3)
    level = Planner(model, limits=LIMITS, options=OPTIONS).to(goal, start=start)
    slid = placed(uncertain_path(model, level, ground=grade, at=start).poses, start)[-1]
    assert math.dist(slid[:2], goal[:2]) > 0.05


def test_on_a_map_of_elevations_a_path_is_planned_where_the_map_is_and_refused_beside_it() -> None:
    slope = ElevationMap(0.1 * np.mgrid[0:21, 0:21][0], origin=(-5.0, -5.0), cell=0.5)
    planner = Planner(sliding(), limits=LIMITS, options=OPTIONS, ground=slope)
    goal = (2.5, 1.0, 0.4)
    path = uncertain_path(sliding(), planner.to(goal), ground=slope)
    assert path.poses[-1] == pytest.approx(goal, abs=2e-3)
    with pytest.raises(SettingsError, match="the path leads beside the map of elevations"):
        planner.to((6.5, 0.0, 0.0))
    assert planner.try_to((6.5, 0.0, 0.0)) is None


def test_commands_stay_within_the_limits(planner: Planner) -> None:
    plan = planner.to((3.0, 1.5, 1.2))
    t, v, omega = plan.commands.T
    assert np.abs(v).max() <= 1.0 + 1e-9
    assert np.abs(omega).max() <= LIMITS.yaw_rate + 1e-9
    assert (np.abs(omega) <= LIMITS.curvature * np.abs(v) + 1e-9).all()
    assert (np.abs(np.diff(v)) <= LIMITS.acceleration * np.diff(t) + 1e-9).all()
    assert v[-1] == 0.0


def test_a_goal_in_another_frame_gives_the_same_commands(planner: Planner) -> None:
    here = planner.to((3.013, 1.027, 0.411))
    start = (10.0, -5.0, math.pi / 2.0)
    there = planner.to((10.0 - 1.027, -5.0 + 3.013, math.pi / 2.0 + 0.411), start=start)
    assert there.commands == pytest.approx(here.commands, abs=1e-9)
    assert there.poses[-1] == pytest.approx((8.973, -1.987, math.pi / 2.0 + 0.411), abs=2e-3)


def test_goals_are_reached_through_the_limits_of_the_drive() -> None:
    model = make_model(replace(named("full-linear-6", lat__w=0.1, ang__w=-0.3), commands=True, limits=AXES))
    planner = Planner(
        model, limits=Limits(speed=1.0, yaw_rate=0.7, curvature=1.0), options=TrajectoryOptions()
    )
    free = make_model(replace(named("full-linear-6", lat__w=0.1, ang__w=-0.3), commands=True))
    for goal in ((4.0, 0.0, 0.0), (3.5, 1.0, 0.6), (5.0, -1.5, -0.3), (4.0, 0.5, -0.2)):
        plan = planner.to(goal)
        assert uncertain_path(model, plan).poses[-1] == pytest.approx(goal, abs=2e-3)
        assert abs(uncertain_path(free, plan).poses[-1, 0] - goal[0]) > 5e-3


def test_a_moving_robot_goes_on_with_its_curvature() -> None:
    state = DriveState(drive=(0.8, 0.2), commanded=(0.8, 0.24))
    plan = trajectory_to(learned_model(), (4.0, 0.5, 0.0), limits=LIMITS, options=OPTIONS, state=state)
    assert plan.commands[0, 1] == pytest.approx(0.8, abs=0.2)
    assert plan.commands[0, 2] / plan.commands[0, 1] == pytest.approx(0.3, abs=0.1)


def slow_model(fraction: float, seconds: float) -> Model:
    values = {"slow_fraction_v": fraction, "log_slow_time_constant_v": math.log(seconds), "gain_v": 1.0}
    values |= {
        "slow_fraction_omega": fraction,
        "log_slow_time_constant_omega": math.log(seconds),
        "gain_omega": 1.0,
    }
    return make_model(Made(_core.named_basis("edd-2"), values, response=True))


@pytest.mark.parametrize(("fraction", "seconds"), [(0.14, 7.0), (0.3, 1.5), (0.5, 4.0)])
def test_a_plan_ends_when_the_robot_is_slower_than_what_counts_as_rest(
    fraction: float, seconds: float
) -> None:
    model = slow_model(fraction, seconds)
    for goal in ((4.0, 0.0, 0.0), (3.0, 1.0, 0.3)):
        plan = Planner(model, limits=Limits(1.0, 1.0, 1.0)).to(goal)
        assert plan.poses[-1] == pytest.approx(goal, abs=2e-3)
        assert max(map(abs, plan.at_end.drive)) <= 0.0205
        last = plan.t > plan.duration - 1.0
        moved = np.hypot(*np.diff(plan.poses[last][:, :2], axis=0).T) / np.diff(plan.t[last])
        assert moved.max() > 0.015  # it does not wait for longer than it must
        assert np.abs(plan.poses[:, 2]).max() < 1.5  # it does not turn round on its way


def test_what_counts_as_rest_is_an_option() -> None:
    model = slow_model(0.3, 3.0)
    seconds = [
        Planner(model, limits=Limits(1.0, 1.0, 1.0), options=TrajectoryOptions(rest_speed=v, rest_yaw_rate=v))
        .to((4.0, 0.0, 0.0))
        .duration
        for v in (0.01, 0.1)
    ]
    assert seconds[0] == pytest.approx(seconds[1] + 3.0 * math.log(10.0), rel=0.2)


def test_limits_follow_from_what_the_model_has_seen() -> None:
    limits = limits_of(learned_model())
    seen = learned_model().content.range
    assert limits.speed == max(map(abs, seen.speed))
    assert limits.yaw_rate == max(map(abs, seen.yaw_rate))
    assert limits.acceleration == ACCELERATION
    tight = {"speed": {"saturation": 0.9, "slew_rate_up": 0.4}, "yaw_rate": {"saturation": 0.5}}
    limits = limits_of(make_model(replace(named("edd-2"), commands=True, limits=tight)))
    assert (limits.speed, limits.yaw_rate, limits.acceleration) == (0.9, 0.5, 0.4)


def test_an_unreachable_goal_says_how_near_it_came_and_what_would_help(planner: Planner) -> None:
    with pytest.raises(PlanningError, match="the nearest attempt ends") as caught:
        planner.to((0.0, 0.5, 0.0))
    assert "larger curvature" in caught.value.advice
    with pytest.raises(PlanningError, match="farther than the longest path"):
        planner.to((50.0, 0.0, 0.0))
    assert planner.try_to((0.0, 0.5, 0.0)) is None


@pytest.mark.parametrize("goal", [(math.nan, 0.0, 0.0), (1.0, math.inf, 0.0), (1.0, 2.0)])
def test_a_goal_that_is_no_pose_is_refused(planner: Planner, goal: tuple[float, ...]) -> None:
    with pytest.raises(SettingsError, match="the goal is not a pose"):
        planner.to(goal)  # type: ignore[arg-type]


def test_options_that_contradict_the_limits_are_refused() -> None:
    with pytest.raises(SettingsError, match="cruise speed"):
        Planner(learned_model(), limits=LIMITS, options=TrajectoryOptions(cruise=9.0))
    with pytest.raises(SettingsError, match="limit yaw_rate"):
        Limits(speed=1.0, yaw_rate=0.0, curvature=1.0)
    with pytest.raises(SettingsError, match="not finite"):
        DriveState(drive=(math.nan, 0.0))


def test_pose_is_said_to_the_millimetre_without_a_tail_of_rounding() -> None:
    assert pose_text((10.0, -1e-9, 1.259e-08)) == "10, 0, 0"
    assert pose_text((12345.6784, 1.2346, -0.5)) == "12345.678, 1.235, -0.5"
