# SPDX-License-Identifier: Apache-2.0
"""The map of the drive, one for each run and frame."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from slipwise.logs.log import Floats, Run
from slipwise.reporting.chosen_windows import ChosenWindow, choose_windows
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import TOP_BAR_MARGIN, Figure, axis, numbers, top_colour_bar
from slipwise.reporting.markup import missing, paragraph
from slipwise.reporting.palette import MEASURED, SEQUENTIAL
from slipwise.reporting.thinning import thinned, thinning_note

_MOST_MAPS = 6
_SIDES = ("top right", "bottom right", "top left", "bottom left")  # of the numbers: neighbours part


@dataclass(frozen=True, eq=False)
class _Drive:
    """The poses of one run in one frame, relative to the first of them."""

    run: int
    name: str
    origin: tuple[float, float]  # m
    t: Floats  # s
    x: Floats  # m
    y: Floats  # m


class DriveMapSection:
    """Where did the robot go?"""

    title = "Where the robot drove"
    explanation = (
        "Measured positions relative to the first one, coloured by time; the numbers mark the starts of the "
        "paths shown further down."
    )

    def html(self, contents: Contents) -> str:
        """Return a map for each of the longest runs and frames."""
        drives = [drive for place, run in enumerate(contents.log.runs) for drive in _drives(place, run)]
        if not drives:
            return missing("The log has no measured poses, so there is no map.")
        longest = sorted(sorted(drives, key=lambda d: -len(d.t))[:_MOST_MAPS], key=lambda d: (d.run, d.t[0]))
        chosen = choose_windows(contents)
        one = len(longest) == 1
        figures = [_figure(place, drive, chosen, one) for place, drive in enumerate(longest, start=1)]
        note = ""
        if len(drives) > _MOST_MAPS:
            note = paragraph(
                f"The {_MOST_MAPS} longest of {len(drives)} drives are shown; "
                "poses are comparable only inside one frame."
            )
        kind = "one" if one else "wide-grid"
        return f'<div class="{kind}">' + "".join(figure.html() for figure in figures) + "</div>" + note


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


def _figure(place: int, drive: _Drive, chosen: list[ChosenWindow], one: bool) -> Figure:
    keep = thinned(len(drive.t))
    x, y, t = drive.x[keep], drive.y[keep], drive.t[keep] - drive.t[0]
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
            "xaxis": axis("x [m]"),
            "yaxis": axis("y [m]", scaleanchor="x", scaleratio=1),
        },
        height=560 if one else 400,
        aspect=float(np.ptp(drive.y) / max(np.ptp(drive.x), 1e-3)),
        caption=thinning_note(len(drive.t)),
    )


def _starts(drive: _Drive, chosen: list[ChosenWindow]) -> dict[str, object]:
    here = [c for c in chosen if c.run == drive.run and drive.t[0] <= c.t_start <= drive.t[-1]]
    at = np.array([c.t_start for c in here], dtype=np.float64)
    return {
        "type": "scatter",
        "mode": "markers+text",
        "cliponaxis": False,
        "x": numbers(np.interp(at, drive.t, drive.x)),
        "y": numbers(np.interp(at, drive.t, drive.y)),
        "text": [str(c.number) for c in here],
        "textposition": [_SIDES[c.number % len(_SIDES)] for c in here],
        "textfont": {"size": 14, "color": MEASURED},
        "marker": {"size": 9, "color": "#ffffff", "line": {"color": MEASURED, "width": 2}},
        "hovertemplate": "start of path %{text}<extra></extra>",
    }
