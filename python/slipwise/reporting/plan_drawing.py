# SPDX-License-Identifier: Apache-2.0
"""What a drawn plan consists of: the map's cells, the swept path, ellipses of uncertainty, start and goal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.ellipse import ellipse
from slipwise.ground import Pose
from slipwise.planning.grid_map import GridMap
from slipwise.planning.route import Route

Floats = NDArray[np.float64]

SWEPT_STEP = 0.5  # of the radius, between the discs that are drawn as the swept path
ELLIPSES = 12  # at most
ARC_POINTS = 33
OCCUPIED, SWEPT, PATH, SPREAD, GOAL = "#566270", "#9fd6c2", "#00694d", "#d55e00", "#0072b2"


@dataclass(frozen=True)
class Plan:
    """A route with what it was planned for."""

    route: Route
    grid: GridMap
    radius: float  # m, of the robot's disc
    start: Pose
    goal: Pose
    title: str


def outline(plan: Plan) -> list[Floats]:
    """Return the outlines [ARC_POINTS, 2] of the robot's disc along the path."""
    poses = plan.route.predicted
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T))))
    wanted = np.append(np.arange(0.0, along[-1], SWEPT_STEP * plan.radius), along[-1])
    angle = np.linspace(0.0, 2.0 * np.pi, ARC_POINTS)
    circle = plan.radius * np.column_stack((np.cos(angle), np.sin(angle)))
    centres = np.column_stack([np.interp(wanted, along, poses[:, i]) for i in (0, 1)])
    return [circle + centre for centre in centres]


def ellipses(plan: Plan) -> list[Floats]:
    """Return the 95 % ellipses of some positions along the path, in the map's frame."""
    route = plan.route
    rows = np.unique(np.linspace(0, len(route.times) - 1, ELLIPSES + 1).astype(int))[1:]
    cos, sin = np.cos(plan.start[2]), np.sin(plan.start[2])
    turned = np.array([[cos, -sin], [sin, cos]])
    found = (
        ellipse(
            route.predicted[row, :2],
            turned @ route.covariance[row, :2, :2] @ turned.T,
            float(route.dof[row]),
        )
        for row in rows
    )
    return [curve for curve in found if curve is not None]


def extent(plan: Plan) -> tuple[float, float, float, float]:
    """Return the map's left, right, bottom and top [m]."""
    (x, y), (width, height) = plan.grid.origin, plan.grid.size
    return x, x + width, y, y + height
