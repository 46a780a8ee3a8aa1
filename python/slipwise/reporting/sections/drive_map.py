# SPDX-License-Identifier: Apache-2.0
"""Maps of the drives, one for each run and frame."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from slipwise.logs.log import Floats, Run
from slipwise.reporting.chosen_windows import ChosenWindow, choose_windows
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import (
    TOP_BAR_MARGIN,
    Figure,
    axis,
    curve,
    numbers,
    thinned,
    thinning_note,
    top_colour_bar,
)
from slipwise.reporting.palette import MEASURED, SEQUENTIAL
from slipwise.reporting.timeline import Timeline

_MOST_MAPS = 6
HEIGHT = 235  # px, of a map and of a path
_DRAWN = ((280.0, 135.0), (305.0, 148.0), (410.0, 148.0), (450.0, 160.0))  # px, of the plot on any screen
_TEXT = (14.0, 20.0)  # px, half a number and the room around it
_RINGS = (17.0, 30.0, 44.0)  # px from a start to its number


@dataclass(frozen=True, eq=False)
class _Drive:
    """The poses of one run in one frame, relative to the first of them."""

    run: int
    name: str
    origin: tuple[float, float]  # m
    t: Floats  # s
    x: Floats  # m
    y: Floats  # m


def drive_maps(contents: Contents) -> tuple[list[Figure], str]:
    """Return a map for each run and frame, that with most starts of paths first, and what is not shown."""
    drives = [drive for place, run in enumerate(contents.log.runs) for drive in _drives(place, run)]
    chosen, timeline = choose_windows(contents), Timeline.of(contents.log)
    drives.sort(key=lambda drive: (-len(_starts(drive, chosen)), -len(drive.t)))
    figures = [
        _figure(place, drive, _starts(drive, chosen), timeline)
        for place, drive in enumerate(drives[:_MOST_MAPS], start=1)
    ]
    if len(drives) <= _MOST_MAPS:
        return figures, ""
    note = f"Of {len(drives)} drives the {_MOST_MAPS} with the most paths are shown; "
    note += "poses are comparable only inside one frame."
    return figures, note


def _drives(place: int, run: Run) -> list[_Drive]:
    """Split the poses of a run wherever the frame changes."""
    poses = run.poses
    if not len(poses):
        return []
    edges = [0, *(np.flatnonzero(np.diff(poses.frame)) + 1).tolist(), len(poses)]
    drives = []
    for a, b in pairwise(edges):
        name = run.name if len(edges) == 2 else f"{run.name}, frame {poses.frame[a]}"
        x, y = poses.x[a:b], poses.y[a:b]
        drives.append(_Drive(place, name, (float(x[0]), float(y[0])), poses.t[a:b], x - x[0], y - y[0]))
    return drives


def _figure(place: int, drive: _Drive, starts: list[ChosenWindow], timeline: Timeline) -> Figure:
    keep = thinned(len(drive.t))
    x, y = drive.x[keep], drive.y[keep]
    t = timeline.at(np.full(len(keep), drive.run), drive.t[keep])
    marker = {
        "size": 4,
        "color": numbers(t),
        "colorscale": SEQUENTIAL,
        "colorbar": top_colour_bar(),
    }
    path = curve(
        x,
        y,
        mode="lines+markers",
        line={"color": "#c3cad3", "width": 1},
        marker=marker,
        customdata=numbers(t),
        hovertemplate="x %{x:.2f} m, y %{y:.2f} m<br>%{customdata:.1f} s<extra></extra>",
    )
    return Figure(
        key=f"map-{place}",
        label=f"Map of the drive {drive.name}",
        heading=f"{drive.name}: the colour is the time [s]",
        traces=[path, _marks(drive, starts)],
        layout={
            "margin": TOP_BAR_MARGIN,
            "xaxis": axis("x [m]", nticks=7),
            "yaxis": axis("y [m]", scaleanchor="x", scaleratio=1, nticks=7),
            "annotations": _numbers(drive, starts),
        },
        height=HEIGHT,
        caption=thinning_note(len(drive.t)),
    )


def _starts(drive: _Drive, chosen: list[ChosenWindow]) -> list[ChosenWindow]:
    return [c for c in chosen if c.run == drive.run and drive.t[0] <= c.t_start <= drive.t[-1]]


def _places(drive: _Drive, starts: list[ChosenWindow]) -> Floats:
    """Return where the paths start, [N, 2] m."""
    at = np.array([start.t_start for start in starts], dtype=np.float64)
    return np.column_stack((np.interp(at, drive.t, drive.x), np.interp(at, drive.t, drive.y)))


def _marks(drive: _Drive, starts: list[ChosenWindow]) -> dict[str, object]:
    places = _places(drive, starts)
    return curve(
        places[:, 0],
        places[:, 1],
        mode="markers",
        text=[str(start.number) for start in starts],
        marker={"size": 8, "color": "#ffffff", "line": {"color": MEASURED, "width": 2}},
        hovertemplate="start of path %{text}<extra></extra>",
    )


def _numbers(drive: _Drive, starts: list[ChosenWindow]) -> list[dict[str, object]]:
    """Return the number of each start, a line away from it, where no other number or start is.

    Whether there is room is judged in pixels, for maps on phones and on desks.
    """
    places = _places(drive, starts)
    extent = np.maximum((np.ptp(drive.x), np.ptp(drive.y)), 1e-3)
    scales = np.array([min(np.array(drawn) / (1.1 * extent)) for drawn in _DRAWN])  # px/m
    points = scales[:, None, None] * places * (1.0, -1.0)  # [scale, N, 2] px, down positive
    angles = np.radians(np.arange(-45.0, 315.0, 45.0))
    ways = np.concatenate([ring * np.column_stack((np.cos(angles), np.sin(angles))) for ring in _RINGS])
    taken = list(points.swapaxes(0, 1))  # [scale, 2] each: the starts, then the numbers placed
    shown = []
    for place, start in enumerate(starts):
        room = [min(_room(points[:, place] + way, other) for other in taken) for way in ways]
        free = next((k for k, clear in enumerate(room) if clear >= 1.0), int(np.argmax(room)))
        taken.append(points[:, place] + ways[free])
        shown.append(
            {
                "x": float(places[place, 0]),
                "y": float(places[place, 1]),
                "text": str(start.number),
                "ax": float(ways[free, 0]),
                "ay": float(ways[free, 1]),
                "arrowhead": 0,
                "arrowwidth": 1,
                "arrowcolor": MEASURED,
                "standoff": 5,
                "borderpad": 0,
                "bgcolor": "rgba(255,255,255,0.8)",
                "font": {"size": 13, "color": MEASURED},
            }
        )
    return shown


def _room(number: Floats, other: Floats) -> float:
    """Return how far two things [scale, 2] are apart on the smaller map; they are clear from 1 on."""
    return float((np.abs(number - other) / _TEXT).max(axis=1).min())
