# SPDX-License-Identifier: Apache-2.0
"""The page of a plan: the swept path on the map with its uncertainty, the commands, and the figures."""

from __future__ import annotations

from typing import Any

import numpy as np

from slipwise.planning.trajectory import pose_text
from slipwise.reporting.figure import Figure, curve, map_axes, step_lines
from slipwise.reporting.markup import bullets, legend, number
from slipwise.reporting.page import Part, page_of
from slipwise.reporting.plan_drawing import (
    GOAL,
    OCCUPIED,
    PATH,
    SPREAD,
    SWEPT,
    Plan,
    ellipses,
    extent,
    outline,
)
from slipwise.student import ellipse_squared

HIGHEST = 900  # px
_LINES = {
    "v": ("speed [m/s]", PATH),
    "vy": ("to the left [m/s]", GOAL),
    "omega": ("yaw rate [rad/s]", SPREAD),
}


def plan_page(plan: Plan) -> str:
    """Return one self-contained HTML page that works offline."""
    parts = (
        Part("The plan", "What it is and how much room it leaves.", bullets(summary(plan))),
        Part(
            "On the map",
            "The robot's disc along the path, and where its middle is with 95 % probability: without looking "
            "at any pose on the way.",
            _legend() + _map(plan).html(),
        ),
        Part("Commands", "What is commanded; each command is held until the next.", _commands(plan).html()),
    )
    return page_of(plan.title, "slipwise plan", parts)


def summary(plan: Plan) -> list[str]:
    """Return the plan in a few sentences."""
    route = plan.route
    radius = np.sqrt(ellipse_squared(0.95, float(route.dof[-1])))
    spread = np.sqrt(np.linalg.eigvalsh(route.covariance[-1][:2, :2]).max())
    pieces = "one manoeuvre" if route.legs == 1 else f"{route.legs} manoeuvres, one after the other"
    end = route.predicted[-1]
    what = (
        f"From {pose_text(plan.start)} to {pose_text(plan.goal)} (x, y in metres, yaw in radians): {pieces}, "
        f"{number(route.trajectory.duration)} s."
    )
    where = (
        f"The predicted end is {pose_text((float(end[0]), float(end[1]), float(end[2])))}; its longest 95 % "
        f"half-axis is {number(radius * float(spread))} m."
    )
    room = (
        f"The robot's disc of {number(plan.radius)} m keeps at least {number(route.clearance)} m from what "
        "is not known to be free, without the uncertainty."
    )
    return [what, where, room]


def _legend() -> str:
    return legend(
        (
            ("occupied or unknown", OCCUPIED, "area"),
            ("swept by the robot", SWEPT, "area"),
            ("predicted path", PATH, "line"),
            ("95 % of positions", SPREAD, "line"),
            ("goal", GOAL, "mark"),
        )
    )


def _map(plan: Plan) -> Figure:
    left, right, bottom, top = extent(plan)
    cell = plan.grid.resolution
    rows, columns = plan.grid.occupied.shape
    cells: dict[str, Any] = {
        "type": "heatmap",
        "z": plan.grid.occupied.astype(int).tolist(),
        "x0": left + cell / 2,
        "dx": cell,
        "y0": bottom + cell / 2,
        "dy": cell,
        "colorscale": [[0, "#ffffff"], [1, OCCUPIED]],
        "zmin": 0,
        "zmax": 1,
        "showscale": False,
        "hoverinfo": "skip",
    }
    swept = [_line(disc, SWEPT, fill=True) for disc in outline(plan)]
    spread = [_line(ring, SPREAD) for ring in ellipses(plan)]
    path = _line(plan.route.predicted[:, :2], PATH, width=2.5)
    goal = curve(
        [plan.goal[0]],
        [plan.goal[1]],
        mode="markers",
        marker={"symbol": "x", "size": 10, "color": GOAL},
        name="goal",
    )
    return Figure(
        key="plan",
        label="map with the swept path and its uncertainty",
        traces=[cells, *swept, *spread, path, goal],
        layout=map_axes(left, right, bottom, top),
        height=HIGHEST,
        aspect=rows / columns,
    )


def _line(points: Any, colour: str, *, fill: bool = False, width: float = 1.5) -> dict[str, Any]:
    line = curve(
        points[:, 0],
        points[:, 1],
        line={"color": colour, "width": 0.0 if fill else width},
        hoverinfo="skip" if fill else "x+y",
    )
    return line | ({"fill": "toself", "fillcolor": colour, "opacity": 0.35} if fill else {})


def _commands(plan: Plan) -> Figure:
    trajectory = plan.route.trajectory
    lines = {_LINES[name][0]: (values, _LINES[name][1]) for name, values in trajectory.columns.items()}
    return step_lines(trajectory.commands[:, 0], lines)
