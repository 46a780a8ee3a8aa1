# SPDX-License-Identifier: Apache-2.0
"""Maps of the drives, one for each run and frame."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from slipwise.logs.log import Floats, Run
from slipwise.reporting.chosen_windows import ChosenWindow, choose_windows
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.palette import MEASURED, SEQUENTIAL
from slipwise.reporting.thinning import thinned, thinning_note
from slipwise.reporting.timeline import Timeline

_MOST_MAPS = 6
HEIGHT = 235  # px, of a map and of a path
_SIDES = {  # where a number may stand beside its start, and in which direction
    "top right": (1.0, 1.0),
    "bottom right": (1.0, -1.0),
    "top left": (-1.0, 1.0),
    "bottom left": (-1.0, -1.0),
}
_LABEL_AWAY = 0.06  # of the map's larger side, between a start and its number


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
    """Return a map for each of the longest runs and frames, the longest first, and what is not shown."""
    drives = [drive for place, run in enumerate(contents.log.runs) for drive in _drives(place, run)]
    chosen, timeline = choose_windows(contents), Timeline.of(contents.log)
    longest = sorted(drives, key=lambda d: -len(d.t))[:_MOST_MAPS]
    figures = [_figure(place, drive, chosen, timeline) for place, drive in enumerate(longest, start=1)]
    if len(drives) <= _MOST_MAPS:
        return figures, ""
    note = f"The {_MOST_MAPS} longest of {len(drives)} drives are shown; "
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


def _figure(place: int, drive: _Drive, chosen: list[ChosenWindow], timeline: Timeline) -> Figure:
    keep = thinned(len(drive.t))
    x, y = drive.x[keep], drive.y[keep]
    t = timeline.at(np.full(len(keep), drive.run), drive.t[keep])
    marker = {
        "size": 4,
        "color": numbers(t),
        "colorscale": SEQUENTIAL,
        "colorbar": top_colour_bar(),
    }
    path = {
        "type": "scatter",
        "mode": "lines+markers",
        "x": numbers(x),
        "y": numbers(y),
        "line": {"color": "#c3cad3", "width": 1},
        "marker": marker,
        "customdata": numbers(t),
        "hovertemplate": "x %{x:.2f} m, y %{y:.2f} m<br>%{customdata:.1f} s<extra></extra>",
    }
    return Figure(
        key=f"map-{place}",
        label=f"Map of the drive {drive.name}",
        heading=f"{drive.name}: the colour is the time [s]",
        traces=[path, _starts(drive, chosen)],
        layout={
            "margin": TOP_BAR_MARGIN,
            "xaxis": axis("x [m]", nticks=7),
            "yaxis": axis("y [m]", scaleanchor="x", scaleratio=1, nticks=7),
        },
        height=HEIGHT,
        caption=thinning_note(len(drive.t)),
    )


def _starts(drive: _Drive, chosen: list[ChosenWindow]) -> dict[str, object]:
    here = [c for c in chosen if c.run == drive.run and drive.t[0] <= c.t_start <= drive.t[-1]]
    at = np.array([c.t_start for c in here], dtype=np.float64)
    x, y = np.interp(at, drive.t, drive.x), np.interp(at, drive.t, drive.y)
    return {
        "type": "scatter",
        "mode": "markers+text",
        "cliponaxis": False,
        "x": numbers(x),
        "y": numbers(y),
        "text": [str(c.number) for c in here],
        "textposition": _free_sides(np.column_stack((x, y)), max(np.ptp(drive.x), np.ptp(drive.y))),
        "textfont": {"size": 14, "color": MEASURED},
        "marker": {"size": 9, "color": "#ffffff", "line": {"color": MEASURED, "width": 2}},
        "hovertemplate": "start of path %{text}<extra></extra>",
    }


def _free_sides(points: Floats, size: float) -> list[str]:
    """Choose for each point [N, 2] the side of its number that is farthest from points and other numbers."""
    taken = list(points)
    sides = []
    for point in points:
        places = {side: point + _LABEL_AWAY * size * np.array(way) for side, way in _SIDES.items()}
        room = {
            side: min(float(np.linalg.norm(place - other)) for other in taken)
            for side, place in places.items()
        }
        sides.append(max(room, key=lambda side: room[side]))
        taken.append(places[sides[-1]])
    return sides
