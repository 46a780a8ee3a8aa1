# SPDX-License-Identifier: Apache-2.0
"""Where the robot drove, and measured and predicted paths from chosen starts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.statistics import held_out_half
from slipwise.ellipse import ellipse
from slipwise.evaluation.result import Predictions
from slipwise.reporting.chosen_windows import ChosenWindow, choose_windows
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.figure import Figure, axis, baseline_label, curve, thinned
from slipwise.reporting.markup import details, grid, legend, missing, number, paragraph
from slipwise.reporting.method_names import BASELINE, label
from slipwise.reporting.palette import MEASURED, stroke_of, transparent
from slipwise.reporting.sections.drive_map import HEIGHT, drive_maps
from slipwise.reporting.timeline import Timeline
from slipwise.reporting.window_paths import WindowPaths, window_paths

_POINTS = 100  # of one path
_SHOWN_AT_ONCE = 3  # beside the map; the others are folded away


class PathsSection:
    """Does the predicted path follow the measured one?"""

    title = "Where the robot drove, and what was predicted"
    explanation = (
        "Numbers on the map are starts of paths, seen from the robot there. An ellipse should hold 95 of 100 "
        "ends."
    )

    def html(self, contents: Contents) -> str:
        """Return the map of the longest drive beside a small figure for each chosen window."""
        drawn, note = drive_maps(contents)
        maps = [figure.html() for figure in drawn]
        text, paths = _paths(contents)
        first = maps[0] if maps else missing("The log has no measured poses, so there is no map.")
        shown = grid([f'<div class="double">{first}</div>', *paths[:_SHOWN_AT_ONCE]], kind="fine-grid")
        folded = _folded((paths[_SHOWN_AT_ONCE:], "paths"), (maps[1:], "maps"))
        return text + shown + folded + (paragraph(note, kind="note") if note else "")


def _folded(*kinds: tuple[Sequence[str], str]) -> str:
    """Fold away the figures that are not shown at once, counted by kind."""
    counted = " and ".join(f"{len(figures)} more {what}" for figures, what in kinds if figures)
    figures = [figure for some, _ in kinds for figure in some]
    return details(counted, grid(figures, kind="fine-grid")) if figures else ""


def typical_path(contents: Contents) -> str:
    """Draw the window whose error comes nearest to the mean one; empty where none can be drawn."""
    drawn, predictions = (
        _drawn(contents),
        contents.predictions(contents.learned_method, contents.longest_horizon),
    )
    if not drawn or predictions is None:
        return ""
    window = _typical(drawn, predictions)
    return (
        _legend(contents, predictions.method)
        + _figure(contents, window, drawn[window], (predictions, Timeline.of(contents.log))).html()
    )


def _typical(drawn: Mapping[ChosenWindow, WindowPaths], predictions: Predictions) -> ChosenWindow:
    misses = np.linalg.norm(predictions.pose[:, :2] - predictions.measured[:, :2], axis=1)
    usual = float(np.nanmean(misses[held_out_half(len(misses))]))
    return min(drawn, key=lambda window: abs(float(misses[window.row]) - usual))


def _drawn(contents: Contents) -> dict[ChosenWindow, WindowPaths]:
    """Return the chosen windows whose paths are in the log, by their numbers."""
    if "paths" not in contents.kept:
        drawn = window_paths(contents, choose_windows(contents))
        contents.kept["paths"] = dict(sorted(drawn.items(), key=lambda item: item[0].number))
    paths: dict[ChosenWindow, WindowPaths] = contents.kept["paths"]
    return paths


def _paths(contents: Contents) -> tuple[str, list[str]]:
    """Return legend and notes, and the figures but that of the typical path, which stands above."""
    method = contents.learned_method
    predictions = contents.predictions(method, contents.longest_horizon)
    if predictions is None or method is None or not len(predictions):
        return missing(
            "No window was predicted at the longest horizon, so there are no paths to compare."
        ), []
    drawn = _drawn(contents)
    if not drawn:
        absent = "The poses or inputs of the predicted windows are not in the log, so no path is drawn."
        return missing(absent), []
    timeline, above = Timeline.of(contents.log), _typical(drawn, predictions)
    figures = [
        _figure(contents, window, path, (predictions, timeline)).html()
        for window, path in drawn.items()
        if window != above
    ]
    return _legend(contents, method) + _notes(list(drawn.values())), figures


def _legend(contents: Contents, method: str) -> str:
    methods = contents.evaluation.methods
    ours, name = stroke_of(method, methods).colour, label(method, contents)
    return legend(
        (
            ("measured", MEASURED, "line"),
            (BASELINE, stroke_of(PLAIN, methods).colour, "dash"),
            (name, ours, "line"),
            (f"95 % ellipse of {name}", ours, "area"),
        )
    )


def _notes(drawn: list[WindowPaths]) -> str:
    causal = sum(path.causal for path in drawn)
    if causal == len(drawn):
        text = "Each predicted path uses the parameters known at its start; nothing measured later is in it."
    elif causal == 0:
        text = "The predicted paths use the final model, which may know these windows; the ellipses do not."
    else:
        text = (
            f"{causal} of {len(drawn)} predicted paths use what was known at their start, others at the end."
        )
    ends = "Ellipse and arrow are the scored prediction, which also follows slip that lasts for some seconds."
    return paragraph(f"{text} {ends}", kind="note")


def _figure(
    contents: Contents, window: ChosenWindow, path: WindowPaths, known: tuple[Predictions, Timeline]
) -> Figure:
    predictions, timeline = known
    methods, name = contents.evaluation.methods, baseline_label(label(predictions.method, contents))
    plain, ours = stroke_of(PLAIN, methods), stroke_of(predictions.method, methods)
    end, measured = predictions.pose[window.row], predictions.measured[window.row]
    traces = [
        *_ellipse(predictions, window.row, ours.colour),
        _line(path.plain, BASELINE, plain.colour, "dash", 2.0),
        _line(path.measured, "measured", MEASURED, "solid", 2.5),
        _line(path.predicted, name, ours.colour, "solid", 2.0),
        _arrow(path.plain[-1], f"{BASELINE}: end", plain.colour),
        _arrow(measured, "measured end", MEASURED),
        _arrow(end, f"{name}: scored end", ours.colour),
    ]
    start, end_time = (timeline.seconds(window.run, t) for t in (window.t_start, window.t_end))
    run = f"{contents.log.runs[window.run].name}, " if len(contents.log.runs) > 1 else ""
    return Figure(
        key=f"path-{window.number}",
        label=f"Measured and predicted path number {window.number}",
        heading=f"{window.number}: {run}{start:.1f} s to {end_time:.1f} s",
        traces=traces,
        layout={
            "xaxis": axis("forward x [m]", nticks=5),
            "yaxis": axis("left y [m]", scaleanchor="x", scaleratio=1, nticks=5),
        },
        height=HEIGHT,
        caption=f"{_off(end, measured)} off; baseline {_off(path.plain[-1], measured)}",
    )


def _line(path: NDArray[np.float64], name: str, colour: str, dash: str, width: float) -> dict[str, Any]:
    points = path[thinned(len(path), _POINTS)]
    return curve(
        points[:, 0],
        points[:, 1],
        name=name,
        line={"color": colour, "dash": dash, "width": width},
        hovertemplate=f"{name}<br>x %{{x:.2f}} m, y %{{y:.2f}} m<extra></extra>",
    )


def _arrow(pose: NDArray[np.float64], name: str, colour: str) -> dict[str, Any]:
    """An arrow head at a pose, pointing where the robot does; Plotly's angles go clockwise from up."""
    angle = 90.0 - math.degrees(float(pose[2])) if np.isfinite(pose[2]) else 0.0
    return curve(
        pose[:1],
        pose[1:2],
        mode="markers",
        marker={
            "color": colour,
            "size": 13,
            "symbol": "arrow",
            "angle": round(angle % 360.0, 1),
            "opacity": 0.9,
        },
        hovertemplate=f"{name}<br>x %{{x:.2f}} m, y %{{y:.2f}} m<extra></extra>",
    )


def _off(pose: NDArray[np.float64], measured: NDArray[np.float64]) -> str:
    """Say how far a pose is from the measured one."""
    error = pose - measured
    angle = math.degrees(abs(_core.wrap_angle(float(error[2])))) if np.isfinite(error[2]) else math.nan
    return f"{number(float(np.hypot(error[0], error[1])), 2)} m, {number(angle, 2)}°"


def _ellipse(predictions: Predictions, row: int, colour: str) -> list[dict[str, Any]]:
    covariance = predictions.covariance[row, :2, :2]
    outline = ellipse(predictions.pose[row, :2], covariance, float(predictions.dof[row]))
    if outline is None:
        return []
    return [
        curve(
            outline[:, 0],
            outline[:, 1],
            fill="toself",
            fillcolor=transparent(colour, 0.18),
            line={"color": colour, "width": 1},
            hoverinfo="skip",
        )
    ]
