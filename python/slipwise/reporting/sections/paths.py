# SPDX-License-Identifier: Apache-2.0
"""Measured, plain and predicted paths from chosen starts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.ellipse import ellipse
from slipwise.evaluation.result import Predictions
from slipwise.reporting.chosen_windows import ChosenWindow, choose_windows
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.figure import Figure, axis, numbers, plain_label
from slipwise.reporting.markup import legend, missing, number, paragraph
from slipwise.reporting.palette import MEASURED, stroke_of, transparent
from slipwise.reporting.thinning import thinned
from slipwise.reporting.window_paths import WindowPaths, window_paths

_POINTS = 200  # of one path


class PathsSection:
    """Does the predicted path follow the measured one?"""

    title = "Measured and predicted paths"
    explanation = (
        "Drives of the longest horizon from starts chosen for the variety of their motion, seen from the "
        "robot at the start; arrow heads point where it does, and the ellipse should hold the measured "
        "end in 95 of 100 cases."
    )

    def html(self, contents: Contents) -> str:
        """Return one small figure per chosen window."""
        method = contents.learned_method
        predictions = contents.predictions(method, contents.longest_horizon)
        chosen = choose_windows(contents)
        if predictions is None or method is None or not chosen:
            return missing(
                "No window was predicted at the longest horizon, so there are no paths to compare."
            )
        drawn = window_paths(contents, chosen)
        if not drawn:
            return missing(
                "The poses or inputs of the predicted windows are not in the log, so no path is drawn."
            )
        figures = "".join(
            _figure(contents, window, path, predictions).html() for window, path in drawn.items()
        )
        return _legend(contents, method) + f'<div class="grid">{figures}</div>' + _notes(list(drawn.values()))


def _legend(contents: Contents, method: str) -> str:
    methods = contents.evaluation.methods
    ours = stroke_of(method, methods).colour
    return legend(
        (
            ("measured", MEASURED, "line"),
            (f"{PLAIN}: without slip", stroke_of(PLAIN, methods).colour, "dash"),
            ("predicted by the model", ours, "line"),
            (f"95 % ellipse of the scored prediction of {method}", ours, "area"),
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
    return paragraph(text)


def _figure(contents: Contents, window: ChosenWindow, path: WindowPaths, predictions: Predictions) -> Figure:
    methods = contents.evaluation.methods
    plain, ours = stroke_of(PLAIN, methods), stroke_of(predictions.method, methods)
    end, measured = predictions.pose[window.row], predictions.measured[window.row]
    traces = [
        *_ellipse(predictions, window.row, ours.colour),
        _line(path.plain, PLAIN, plain.colour, "dash", 2.0),
        _line(path.measured, "measured", MEASURED, "solid", 2.5),
        _line(path.predicted, "predicted", ours.colour, "solid", 2.0),
        _arrow(path.plain[-1], f"{PLAIN} end", plain.colour),
        _arrow(measured, "measured end", MEASURED),
        _arrow(end, f"scored prediction of {plain_label(predictions.method)}", ours.colour),
    ]
    run = f"{contents.log.runs[window.run].name}, " if len(contents.log.runs) > 1 else ""
    return Figure(
        key=f"path-{window.number}",
        label=f"Measured, plain and predicted path number {window.number}",
        heading=f"{window.number}: {run}{window.t_start:.1f} s to {window.t_end:.1f} s",
        traces=traces,
        layout={
            "xaxis": axis("forward x [m]", nticks=7),
            "yaxis": axis("left y [m]", scaleanchor="x", scaleratio=1, nticks=7),
        },
        height=300,
        caption=f"End off by {_off(end, measured)}, without slip by {_off(path.plain[-1], measured)}.",
    )


def _line(path: NDArray[np.float64], name: str, colour: str, dash: str, width: float) -> dict[str, Any]:
    points = path[thinned(len(path), _POINTS)]
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": numbers(points[:, 0]),
        "y": numbers(points[:, 1]),
        "line": {"color": colour, "dash": dash, "width": width},
        "hovertemplate": f"{name}<br>x %{{x:.2f}} m, y %{{y:.2f}} m<extra></extra>",
    }


def _arrow(pose: NDArray[np.float64], name: str, colour: str) -> dict[str, Any]:
    """An arrow head at a pose, pointing where the robot does; Plotly's angles go clockwise from up."""
    angle = 90.0 - math.degrees(float(pose[2])) if np.isfinite(pose[2]) else 0.0
    return {
        "type": "scatter",
        "mode": "markers",
        "x": numbers(pose[:1]),
        "y": numbers(pose[1:2]),
        "marker": {
            "color": colour,
            "size": 13,
            "symbol": "arrow",
            "angle": round(angle % 360.0, 1),
            "opacity": 0.9,
        },
        "hovertemplate": f"{name}<br>x %{{x:.2f}} m, y %{{y:.2f}} m<extra></extra>",
    }


def _off(pose: NDArray[np.float64], measured: NDArray[np.float64]) -> str:
    """Say how far a pose is from the measured one."""
    error = pose - measured
    angle = math.degrees(abs(_core.wrap_angle(float(error[2])))) if np.isfinite(error[2]) else math.nan
    return f"{number(float(np.hypot(error[0], error[1])), 2)} m and {number(angle, 2)}°"


def _ellipse(predictions: Predictions, row: int, colour: str) -> list[dict[str, Any]]:
    covariance = predictions.covariance[row, :2, :2]
    outline = ellipse(predictions.pose[row, :2], covariance, float(predictions.dof[row]))
    if outline is None:
        return []
    return [
        {
            "type": "scatter",
            "mode": "lines",
            "x": numbers(outline[:, 0]),
            "y": numbers(outline[:, 1]),
            "fill": "toself",
            "fillcolor": transparent(colour, 0.18),
            "line": {"color": colour, "width": 1},
            "hoverinfo": "skip",
        }
    ]
