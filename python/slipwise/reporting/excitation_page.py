# SPDX-License-Identifier: Apache-2.0
"""The page of a drive that is to be driven: its picture, its commands, and what each move teaches."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.excitation import Excitation, Lesson, command_inputs, drawn_robots
from slipwise.excitation.design import HORIZON
from slipwise.excitation.moves import command_periods
from slipwise.excitation.robots import PERIOD
from slipwise.reporting.figure import LEGEND_ON_TOP, Figure, axis, curve, map_axes, numbers, step_lines
from slipwise.reporting.markup import bullets, legend, number, table
from slipwise.reporting.page import Part, page_of

AREA, ROBOTS, MEAN, START = "#566270", "#9fd6c2", "#00694d", "#0072b2"
YAW, POSITION = "#d55e00", "#0072b2"
DRAWN_ROBOTS = 60
SEED = 7  # of the robots that are drawn
HIGHEST = 900  # px
WATCH = (
    "A person has to watch, with the stop button in hand: nothing looks where the robot is while a bag plays."
)


def excitation_page(drive: Excitation, lessons: Sequence[Lesson], title: str) -> str:
    """Return one self-contained HTML page that works offline."""
    parts = (
        Part("The drive", "How to drive it, and what it gives.", bullets(summary(drive, lessons))),
        Part(
            "In the area",
            f"Where {DRAWN_ROBOTS} robots with slip, lag and delay drawn from what was known would come; "
            "nothing corrects them on their way.",
            _legend() + _map(drive).html(),
        ),
        Part("Commands", "Each command is held until the next.", _commands(drive).html()),
        Part(
            "What each move teaches",
            f"The largest standard deviation of a prediction over {HORIZON:g} s under any command within the "
            "limits, before the drive and after each of its moves.",
            _worst(lessons).html() + _moves(lessons),
        ),
        Part(
            "Parameter by parameter",
            "How much of each parameter's standard deviation before the drive is left after each move.",
            _bars(drive, lessons).html(),
        ),
    )
    return page_of(title, "slipwise excite", parts)


def summary(drive: Excitation, lessons: Sequence[Lesson]) -> list[str]:
    """Return the drive in a few sentences."""
    before, after = lessons[0], lessons[-1]
    options, space = drive.options, drive.space
    fastest = max(abs(move.v) for move in drive.moves)
    quickest = max(abs(move.omega) for move in drive.moves)
    drive_text = (
        f"{len(drive.moves)} moves of {number(options.hold)} s with {number(options.pause)} s of standing "
        f"after each, {number(drive.seconds)} s together. It ends where it began, and left mirrors right."
    )
    limits_text = (
        f"At most {number(fastest)} m/s and {number(quickest)} rad/s; the limits are {number(space.speed)} "
        f"m/s and {number(space.yaw_rate)} rad/s."
    )
    if space.sideways > 0.0:
        aside = max(abs(move.vy) for move in drive.moves)
        limits_text += f" Sideways at most {number(aside)} m/s; the limit is {number(space.sideways)} m/s."
    gain_text = (
        f"The worst prediction of {HORIZON:g} s: yaw ± {number(before.yaw)} rad before the drive and ± "
        f"{number(after.yaw)} rad after it, position ± {number(before.position)} m and ± "
        f"{number(after.position)} m (one standard deviation)."
    )
    place = _place_text(drive)
    return [text for text in (drive_text, limits_text, gain_text, place, WATCH) if text]


def _place_text(drive: Excitation) -> str:
    if drive.options.area is None:
        return ""
    width, depth = (number(side) for side in drive.options.area)
    x, y = (number(value) for value in drive.start)
    return (
        f"In the area of {width} m x {depth} m, put the robot {x} m from the side behind it and {y} m "
        "from the side to its right, facing along the first length."
    )


def _legend() -> str:
    return legend(
        (
            ("the area", AREA, "line"),
            ("drawn robots", ROBOTS, "line"),
            ("the expected robot", MEAN, "line"),
            ("start", START, "mark"),
        )
    )


def _map(drive: Excitation) -> Figure:
    commands = command_periods(drive.moves, PERIOD)
    x, y = drive.start
    robots = drawn_robots(drive.knowledge, DRAWN_ROBOTS, seed=SEED).paths(commands)
    mean = drawn_robots(drive.knowledge.spread_by(0.0), 1, seed=SEED).paths(commands)[0]
    lines = [_line(x + path[0], y + path[1], ROBOTS, 0.8) for path in robots]
    lines.append(_line(x + mean[0], y + mean[1], MEAN, 2.5))
    left, right, bottom, top = drive.box + np.array([x, x, y, y]) + np.array([-1, 1, -1, 1]) * 0.5
    if drive.options.area is not None:
        width, depth = drive.options.area
        corners = np.array([(0.0, 0.0), (width, 0.0), (width, depth), (0.0, depth), (0.0, 0.0)])
        lines.insert(0, _line(corners[:, 0], corners[:, 1], AREA, 2.0))
        left, right, bottom, top = -0.05 * width, 1.05 * width, -0.05 * depth, 1.05 * depth
    start = curve(
        [x],
        [y],
        mode="markers",
        marker={"symbol": "triangle-right", "size": 12, "color": START},
        name="start",
    )
    return Figure(
        key="area",
        label="the area with the paths of drawn robots",
        traces=[*lines, start],
        layout=map_axes(left, right, bottom, top),
        height=HIGHEST,
        aspect=float((top - bottom) / (right - left)),
    )


def _line(x: NDArray[np.float64], y: NDArray[np.float64], colour: str, width: float) -> dict[str, Any]:
    return curve(x, y, line={"color": colour, "width": width}, hoverinfo="skip")


def _commands(drive: Excitation) -> Figure:
    commands = command_inputs(drive)
    lines = {"speed [m/s]": (commands.v, POSITION), "yaw rate [rad/s]": (commands.omega, YAW)}
    if drive.space.sideways > 0.0:
        lines["to the left [m/s]"] = (commands.vy, MEAN)
    return step_lines(commands.t, lines)


def _worst(lessons: Sequence[Lesson]) -> Figure:
    after = {"type": "scatter", "mode": "lines+markers", "x": list(range(len(lessons)))}
    yaw, position = [lesson.yaw for lesson in lessons], [lesson.position for lesson in lessons]
    return Figure(
        key="worst",
        label="the worst prediction after each move",
        traces=[
            after | {"y": numbers(yaw), "name": "yaw [rad]", "line": {"color": YAW}},
            after | {"y": numbers(position), "name": "position [m]", "line": {"color": POSITION}},
        ],
        layout={
            "xaxis": axis("moves driven"),
            "yaxis": axis("standard deviation [rad], [m]", type="log"),
            **LEGEND_ON_TOP,
        },
    )


def _moves(lessons: Sequence[Lesson]) -> str:
    aside = any(lesson.move is not None and lesson.move.vy for lesson in lessons)
    head = (
        "move",
        "speed [m/s]",
        *(("to the left [m/s]",) if aside else ()),
        "yaw rate [rad/s]",
        "worst yaw [rad]",
        "after",
        "worst position [m]",
        "after",
    )
    rows = []
    for place, (before, lesson) in enumerate(pairwise(lessons), start=1):
        if lesson.move is not None:
            what = (
                lesson.move.v,
                *((lesson.move.vy,) if aside else ()),
                lesson.move.omega,
                before.yaw,
                lesson.yaw,
                before.position,
                lesson.position,
            )
            rows.append((str(place), *map(number, what)))
    return table(head, rows)


def _bars(drive: Excitation, lessons: Sequence[Lesson]) -> Figure:
    before = np.where(lessons[0].std > 0.0, lessons[0].std, 1.0)
    left = np.array([lesson.std / before for lesson in lessons[1:]])
    names = list(drive.knowledge.names)
    return Figure(
        key="parameters",
        label="each parameter's standard deviation after each move, as a share of that before",
        traces=[
            {
                "type": "bar",
                "x": list(range(1, len(left) + 1)),
                "y": numbers(left[:, place]),
                "xaxis": "x",
                "yaxis": f"y{place + 1}" if place else "y",
                "marker": {"color": MEAN},
                "name": name,
            }
            for place, name in enumerate(names)
        ],
        layout=_rows(names),
        height=60 * len(names) + 60,
    )


def _rows(names: Sequence[str]) -> dict[str, Any]:
    """Lay one small plot per parameter below the other, the first at the top."""
    share = 1.0 / max(len(names), 1)
    layout: dict[str, Any] = {"xaxis": axis("moves driven", anchor=f"y{len(names)}" if names[1:] else "y")}
    for place in range(len(names)):
        top = 1.0 - place * share
        key = f"yaxis{place + 1}" if place else "yaxis"
        layout[key] = axis("", small=True, range=[0, 1], nticks=2, domain=[top - 0.75 * share, top])
    layout["annotations"] = [
        {
            "text": name,
            "x": 1.0,
            "xref": "paper",
            "xanchor": "right",
            "y": 1.0 - place * share,
            "yref": "paper",
            "yanchor": "top",
            "showarrow": False,
        }
        for place, name in enumerate(names)
    ]
    return layout
