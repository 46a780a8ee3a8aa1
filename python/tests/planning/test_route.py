# SPDX-License-Identifier: Apache-2.0
"""Routes lead round what is in the way, as one drive that ends at the goal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planning.planning_samples import CELL, LIMITS, learned_model, sliding, walled_map
from sample_models import Made, make_model

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError
from slipwise.ground import Grade
from slipwise.planning import GridMap, RouteOptions, RoutePlanner, TrajectoryOptions, uncertain_path
from slipwise.planning.trajectory import placed

OPTIONS = TrajectoryOptions(cruise=0.8, longest=6.0)


def planner(grid: GridMap, *, radius: float = 0.3, attempts: int = 800) -> RoutePlanner:
    search = RouteOptions(radius=radius, attempts=attempts)
    return RoutePlanner(learned_model(), grid, limits=LIMITS, options=OPTIONS, search=search)


def test_a_free_way_is_one_trajectory() -> None:
    route = planner(walled_map()).route((1.0, 6.0, 0.0), (5.5, 6.5, 0.2))
    assert route.legs == 1
    assert route.clearance >= 0.0


def test_a_route_leads_round_a_wall_to_the_goal_without_touching_it() -> None:
    grid = walled_map()
    route = planner(grid).route((1.5, 2.0, 0.5), (10.0, 2.5, -0.6))
    assert route.legs > 1
    assert route.predicted[-1] == pytest.approx((10.0, 2.5, -0.6), abs=0.05)
    assert (grid.clearance_at(route.predicted[:, :2]) >= 0.3).all()
    assert (np.diff(route.trajectory.commands[:, 0]) > 0.0).all()
    spread = route.covariance[:, 0, 0] + route.covariance[:, 1, 1]
    assert spread[-1] > spread[len(spread) // 4] > 0.0


def test_a_route_on_a_hillside_ends_at_the_goal_that_a_level_route_misses() -> None:
    grid = GridMap(np.zeros((300, 300), dtype=bool), CELL)
    start, goal = (10.0, 15.0, 0.0), (18.5, 15.0, -0.5)
    options = TrajectoryOptions(cruise=1.0, longest=6.0)
    hillside = Grade(0.1, downhill=-1.5)
    route = RoutePlanner(
        sliding(), grid, limits=LIMITS, options=options, search=RouteOptions(radius=0.3), ground=hillside
    ).route(start, goal)
    assert route.legs > 1
    assert route.predicted[-1] == pytest.approx(goal, abs=0.05)
    assert route.clearance >= 0.0
    level = uncertain_path(sliding(), route.trajectory)
    assert np.linalg.norm(placed(level.poses, start)[-1, :2] - goal[:2]) > 0.1


def test_manoeuvres_in_a_row_go_on_with_what_the_slow_part_of_the_chain_holds() -> None:
    slow = make_model(
        Made(
            basis=_core.named_basis("edd-2"),
            values={"ang.w": -0.3},
            response=True,
            std=1e-3,
            fraction=0.01,
            psd_motion=1e-5,
        )
    )
    search = RouteOptions(radius=0.3, attempts=800, seed=4)
    routes = RoutePlanner(slow, walled_map(), limits=LIMITS, options=OPTIONS, search=search)
    route = routes.route((1.5, 2.0, 0.5), (10.0, 2.5, -0.6))
    assert route.legs > 1
    assert route.predicted[-1] == pytest.approx(route.trajectory.poses[-1], abs=1e-4)


def test_a_route_that_touches_an_obstacle_as_a_whole_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    routes = planner(walled_map())
    joined = routes._joined
    monkeypatch.setattr(routes, "_joined", lambda node, start: replace(joined(node, start), clearance=-0.1))
    with pytest.raises(PlanningError, match="driven as a whole"):
        routes.route((1.0, 6.0, 0.0), (5.5, 6.5, 0.2))


def test_a_disc_does_not_hang_over_the_edge_of_the_map() -> None:
    open_map = GridMap(np.zeros((100, 100), dtype=bool), 0.1, (-5.0, -5.0))
    with pytest.raises(PlanningError, match="the start lies in or too near an obstacle, or off the map"):
        planner(open_map, radius=2.0).route((-4.95, -4.95, 0.0), (3.0, -4.95, 0.0))
    route = planner(open_map, radius=1.0).route((-3.8, -3.0, 0.0), (1.0, -3.0, 0.0))
    assert np.abs(route.predicted[:, :2]).max() <= 4.0


def test_a_route_whose_position_may_be_anywhere_is_no_plan() -> None:
    vague = make_model(Made(_core.named_basis("edd-2"), commands=True, fraction=0.4, psd_motion=0.3))
    routes = RoutePlanner(
        vague, walled_map(), limits=LIMITS, options=OPTIONS, search=RouteOptions(radius=0.3)
    )
    with pytest.raises(PlanningError, match=r"too uncertain: the 95 % ellipse .* half-axis of .* m, leaves"):
        routes.route((1.0, 6.0, 0.0), (5.5, 6.5, 0.2))


@pytest.mark.parametrize(("changed", "where"), [({"seed": -1}, "seed"), ({"attempts": 0}, "attempts")])
def test_a_search_that_cannot_begin_is_refused(changed: dict[str, int], where: str) -> None:
    with pytest.raises(SettingsError, match=rf"cannot begin \({where}\)"):
        RoutePlanner(learned_model(), walled_map(), search=RouteOptions(**changed))


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ((5.7, 2.0, 0.0), (10.0, 2.0, 0.0), "the start lies in or too near an obstacle"),
        ((1.0, 2.0, 0.0), (5.7, 2.0, 0.0), "the goal lies in or too near an obstacle"),
        ((1.0, 2.0, 0.0), (99.0, 2.0, 0.0), "the goal lies in or too near an obstacle, or off the map"),
    ],
)
def test_a_start_or_goal_in_an_obstacle_is_refused(
    start: tuple[float, float, float], goal: tuple[float, float, float], message: str
) -> None:
    with pytest.raises(PlanningError, match=message):
        planner(walled_map()).route(start, goal)


def test_a_closed_off_goal_is_said_to_have_no_free_route() -> None:
    occupied = walled_map().occupied.copy()
    occupied[:, 55:60] = True
    with pytest.raises(PlanningError, match="no free route was found"):
        planner(GridMap(occupied, 0.1), attempts=30).route((1.0, 2.0, 0.0), (10.0, 2.0, 0.0))


def test_a_map_coarser_than_the_robot_and_a_robot_without_size_are_refused() -> None:
    coarse = GridMap(np.zeros((8, 12), dtype=bool), 1.0)
    with pytest.raises(PlanningError, match="cells of 1 m are larger than the robot"):
        planner(coarse)
    with pytest.raises(SettingsError, match="the radius is 0"):
        planner(walled_map(), radius=0.0)
