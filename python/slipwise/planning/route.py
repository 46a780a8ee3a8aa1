# SPDX-License-Identifier: Apache-2.0
"""Routes through a map: one trajectory where it is free, else several round what is in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError
from slipwise.ground import Ground, Pose
from slipwise.models.model import Model
from slipwise.planning.grid_map import GridMap
from slipwise.planning.limits import AT_REST, DriveState, Limits
from slipwise.planning.trajectory import (
    NOMINAL,
    Planner,
    Trajectory,
    TrajectoryOptions,
    placed,
    pose_text,
    to_core_pose,
    uncertain_path,
)
from slipwise.prediction import Path
from slipwise.student import ellipse_squared

Floats = NDArray[np.float64]

IMPROVING = 200  # further attempts once a route is found
VIA_SPEED = 0.7  # of the cruise speed, between the legs of a route
TURN_AT_VIA = 0.5  # of the widest bearing, how far the heading after a leg may be off that of an arc
VIA_TOLERANCE = 0.05  # m, rad; the next leg starts from where the robot really is
SHORTEST_LEG, LONGEST_LEG = 0.25, 0.8  # of the longest commanded path, as the crow flies
GENTLE = 0.5  # of the largest curvature of commands: slip leaves less of it
TRIED_EFFORT = 0.2  # the same for every leg that was tried from there
BEARING_EFFORT = 1.5  # how much farther a place seems for every radian off the heading
SHARE = 0.95  # of the positions, within the ellipse
POINTS = 48  # of an outline
STEP = 1.0  # cells, between the points along its half-axes


@dataclass(frozen=True)
class RouteOptions:
    """How a route is looked for."""

    radius: float = 0.5  # m, of a disc that covers the robot
    attempts: int = 1500  # legs tried at most
    seed: int = 1  # of the places between the legs


@dataclass(frozen=True, eq=False)
class Route:
    """Commands from start to goal, the path they cause, and how uncertain it is."""

    trajectory: Trajectory
    legs: int  # of which it is put together
    covariance: Floats  # [K, 3, 3] of x, y [m^2], yaw, in the frame of the start; see `slipwise.predict`
    dof: Floats  # [K] degrees of freedom of the Student t with these covariances
    times: Floats  # [K] s, of the covariances
    predicted: Floats  # [K, 3] x, y, yaw in the map's frame at these times
    clearance: float  # m, least distance between the robot's disc and what is occupied


@dataclass(eq=False)
class _Node:
    """A pose reached by legs."""

    pose: Pose
    state: DriveState
    legs: tuple[Trajectory, ...]
    seconds: float
    tried: int = 0  # legs from here


class RoutePlanner:
    """Looks for routes of a model through one map, on level ground or on `ground` in the map's frame.

    Raises:
        SettingsError: options and limits contradict each other.
    """

    def __init__(  # noqa: PLR0913 - what a Planner takes, a map and how it is searched
        self,
        model: Model,
        grid: GridMap,
        *,
        limits: Limits | None = None,
        options: TrajectoryOptions = NOMINAL,
        search: RouteOptions = RouteOptions(),
        ground: Ground | None = None,
    ) -> None:
        if not (math.isfinite(search.radius) and search.radius > 0.0):
            raise SettingsError(
                f"the radius is {search.radius}", where="radius", advice="give metres above 0"
            )
        if search.seed < 0 or search.attempts < 1:
            raise SettingsError(
                f"a search with seed {search.seed} and {search.attempts} attempts cannot begin",
                where="seed" if search.seed < 0 else "attempts",
                advice="give a seed of 0 or more, and one attempt or more",
            )
        if grid.resolution > 2.0 * search.radius:
            raise PlanningError(
                f"cells of {grid.resolution:g} m are larger than the robot of {2 * search.radius:g} m",
                where="map resolution",
                advice="use a finer map, or check the unit of its resolution",
            )
        self._model, self._grid, self._search = model, grid, search
        self._last = Planner(model, limits=limits, options=options, ground=ground)
        cruise = options.to_core(self._last.limits).cruise
        between = replace(
            options,
            end_speed=VIA_SPEED * cruise,
            guesses=1,  # another place is tried rather than another manoeuvre to this one
            tolerance_xy=VIA_TOLERANCE,
            tolerance_yaw=VIA_TOLERANCE,
        )
        self._between = Planner(model, limits=limits, options=between, ground=ground)
        self._longest = options.longest
        self._bend = GENTLE * min(self._last.limits.curvature, self._last.limits.yaw_rate / cruise)  # 1/m

    def route(self, start: Pose, goal: Pose) -> Route:
        """Return a route from rest at `start` to rest at `goal`, both in the map's frame.

        Raises:
            PlanningError: start or goal touch an obstacle, or no route was found.
            SettingsError: a pose is not finite.
        """
        for name, pose in (("start", start), ("goal", goal)):
            to_core_pose(pose, name)
            room = self._room(np.array([pose]))
            if room < 0.0:
                raise PlanningError(
                    f"the {name} lies in or too near an obstacle, or off the map",
                    where=f"{name} {pose_text(pose)}",
                    advice=f"the robot's disc of {self._search.radius:g} m needs {-room:.2g} m more",
                )
        rng = np.random.Generator(np.random.PCG64(self._search.seed))
        nodes = [_Node(start, AT_REST, (), 0.0)]
        best = self._finish(nodes[0], goal)
        left = 0 if best is not None else self._search.attempts
        while left > 0:
            left -= 1
            grown = self._grow(nodes, goal, rng)
            if grown is None:
                continue
            nodes.append(grown)
            finished = self._finish(grown, goal)
            if finished is not None and (best is None or finished.seconds < best.seconds):
                best, left = finished, min(left, IMPROVING)
        if best is None:
            if math.dist(start[:2], goal[:2]) <= self._longest:
                self._last.to(goal, start=start)  # says why, where nothing but the limits is in the way
            raise PlanningError(
                "no free route was found",
                where=f"goal {pose_text(goal)}",
                advice="choose a goal with more room, a smaller radius, a larger curvature or more attempts",
            )
        return self._checked(self._joined(best, start), start)

    def _checked(self, route: Route, start: Pose) -> Route:
        """Refuse a route whose legs, driven one after the other, are not what each was by itself.

        A leg begins with the last command alone; commands before it may still be in the delay. A route is
        refused as well where the robot may be, at 95 %, where it is not free.
        """
        if route.clearance < 0.0:
            raise PlanningError(
                f"driven as a whole, the route of {route.legs} manoeuvres touches an obstacle",
                where=f"clearance {route.clearance:.2g} m",
                advice="use a larger radius, or another seed",
            )
        crossing = first_crossing(
            self._grid, route.predicted[:, :2], route.covariance[:, :2, :2], route.dof, start[2]
        )
        if crossing is not None:
            raise PlanningError(
                f"the route is too uncertain: the 95 % ellipse of the robot's position, with a half-axis of "
                f"{crossing.half_axis:.2g} m, leaves the free space",
                where=f"after {route.times[crossing.at] - route.times[0]:.1f} s of "
                f"{route.times[-1] - route.times[0]:.1f} s",
                advice="choose a nearer goal or a map with more room, or learn the model from more driving",
            )
        return route

    def _room(self, poses: Floats) -> float:
        """Least clearance of the robot's disc along poses [N, 3]; negative where it touches something."""
        return float(self._grid.clearance_at(poses[:, :2]).min()) - self._search.radius

    def _leg(self, planner: Planner, node: _Node, goal: Pose) -> _Node | None:
        if math.hypot(goal[0] - node.pose[0], goal[1] - node.pose[1]) > self._longest:
            return None
        leg = planner.try_to(goal, start=node.pose, state=node.state)
        if leg is None or self._room(leg.poses) < 0.0:
            return None
        x, y, yaw = map(float, leg.poses[-1])
        return _Node((x, y, yaw), leg.at_end, (*node.legs, leg), node.seconds + leg.duration)

    def _finish(self, node: _Node, goal: Pose) -> _Node | None:
        return self._leg(self._last, node, goal)

    def _grow(self, nodes: list[_Node], goal: Pose, rng: np.random.Generator) -> _Node | None:
        """Return a new node towards a random free place, None where there is none."""
        width, height = self._grid.size
        place = np.array(self._grid.origin) + rng.random(2) * (width, height)
        if rng.random() < 0.2:
            place = np.array(goal[:2]) + rng.normal(0.0, 0.2 * self._longest, 2)
        node = min(nodes, key=lambda node: _effort(node, place))
        node.tried += 1
        bearing = _towards(node.pose, place)[1]
        reach = self._longest * rng.uniform(SHORTEST_LEG, LONGEST_LEG)
        widest = math.asin(min(1.0, 0.5 * reach * self._bend))
        bearing = float(np.clip(bearing, -widest, widest))
        heading = node.pose[2] + bearing
        x, y = node.pose[0] + reach * math.cos(heading), node.pose[1] + reach * math.sin(heading)
        # An arc that ends at this bearing has turned by twice as much.
        via = (x, y, heading + bearing + widest * rng.uniform(-TURN_AT_VIA, TURN_AT_VIA))
        return self._leg(self._between, node, via) if self._room(np.array([via])) > 0.0 else None

    def _joined(self, node: _Node, start: Pose) -> Route:
        """Put the legs together and predict them as one drive, with its covariance."""
        begins = np.cumsum([0.0, *(leg.duration for leg in node.legs)])
        commands = np.concatenate([leg.commands for leg in node.legs])
        commands[:, 0] += np.repeat(begins[:-1], [len(leg.commands) for leg in node.legs])
        keep = np.append(np.diff(commands[:, 0]) > 1e-9, True)
        whole = Trajectory(
            commands=commands[keep],
            t=np.concatenate([leg.t + begin for leg, begin in zip(node.legs, begins, strict=False)]),
            poses=np.concatenate([leg.poses for leg in node.legs]),
            at_end=node.state,
        )
        path: Path = uncertain_path(self._model, whole, ground=self._last.ground, at=start)
        poses = placed(path.poses, start)
        return Route(
            trajectory=whole,
            legs=len(node.legs),
            covariance=path.covariance,
            dof=path.dof,
            times=path.t,
            predicted=poses,
            clearance=self._room(poses),
        )


def _towards(pose: Pose, place: Floats) -> tuple[float, float]:
    """Return how far a place is [m] and in which direction it is seen [rad]."""
    x, y = place[0] - pose[0], place[1] - pose[1]
    return math.hypot(x, y), _core.wrap_angle(math.atan2(y, x) - pose[2])


def _effort(node: _Node, place: Floats) -> float:
    """Return how far a place seems from a node; farther off its heading, or after many legs."""
    gap, bearing = _towards(node.pose, place)
    return gap * (1.0 + BEARING_EFFORT * abs(bearing)) * (1.0 + TRIED_EFFORT * node.tried)


@dataclass(frozen=True)
class Crossing:
    """The first ellipse that leaves what is free."""

    at: int  # place among the predictions
    half_axis: float  # m, the longer one


def first_crossing(
    grid: GridMap, positions: Floats, covariance: Floats, dof: Floats, yaw: float
) -> Crossing | None:
    """Return the first ellipse with a place that is not free, None where all are free.

    Args:
        grid: what is free.
        positions: [K, 2] x, y in the map's frame [m].
        covariance: [K, 2, 2] of x, y in the frame of the start [m^2].
        dof: [K] degrees of freedom of the Student t with these covariances.
        yaw: of the start in the map's frame [rad].
    """
    to_map = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    values, vectors = np.linalg.eigh(to_map @ covariance @ to_map.T)
    radius = np.sqrt([ellipse_squared(SHARE, float(freedom)) for freedom in dof])
    axes = radius[:, None] * np.sqrt(np.maximum(values, 0.0))
    for k in range(len(positions)):
        shape = vectors[k] * axes[k]
        if not _is_free(grid, positions[k], shape, float(axes[k, 1])):
            return Crossing(k, float(axes[k, 1]))
    return None


def _is_free(grid: GridMap, centre: Floats, shape: Floats, longer: float) -> bool:
    if not np.isfinite(longer) or 2.0 * longer > max(grid.size):
        return False
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
    rings = np.linspace(0.0, 1.0, 2 + int(longer / (STEP * grid.resolution)))
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    points = (rings[:, None, None] * circle).reshape(-1, 2)
    return bool(grid.clearance_at(centre + points @ shape.T).min() > 0.0)
