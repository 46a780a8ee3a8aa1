# SPDX-License-Identifier: Apache-2.0
"""The error of every predicted window over time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipwise.evaluation.result import Predictions
from slipwise.reporting.contents import PLAIN, SIMPLE, Contents
from slipwise.reporting.figure import (
    CURVE_POINTS,
    Figure,
    axis,
    baseline_label,
    curve,
    thinned,
    thinning_note,
)
from slipwise.reporting.markup import grid, legend, missing
from slipwise.reporting.method_names import label
from slipwise.reporting.palette import stroke_of
from slipwise.reporting.timeline import Timeline, with_breaks


class ErrorsSection:
    """Do the predictions get better while the model learns?"""

    title = "Errors over time"
    explanation = (
        "At the start of each prediction, from the first window on: a model that learns falls below "
        "the baseline and stays there."
    )

    def html(self, contents: Contents) -> str:
        """Return the position and the heading error at the longest horizon."""
        horizon = contents.longest_horizon
        names = dict.fromkeys((PLAIN, SIMPLE, contents.learned_method))
        found = [part for name in names if (part := contents.predictions(name, horizon)) is not None]
        if not found or horizon is None:
            return missing("No window was predicted, so there is no error to show over time.")
        methods = contents.evaluation.methods
        keys = [
            (label(part.method, contents), stroke_of(part.method, methods).colour, _kind(part, contents))
            for part in found
        ]
        figures = (
            _figure(contents, found, "position", "error [m]"),
            _figure(contents, found, "heading", "error [°]"),
        )
        return legend(keys) + grid((figure.html() for figure in figures), kind="wide-grid")


def _kind(part: Predictions, contents: Contents) -> str:
    dash = stroke_of(part.method, contents.evaluation.methods).dash
    return {"dash": "dash", "dot": "dot", "dashdot": "dash"}.get(dash, "line")


def _figure(contents: Contents, found: list[Predictions], what: str, title: str) -> Figure:
    timeline = Timeline.of(contents.log)
    return Figure(
        key=f"error-{what}",
        label=f"The {what} error of each window over time",
        heading=f"{what.capitalize()} error after {found[0].horizon:g} s",
        traces=[_trace(contents, part, what, timeline) for part in found],
        layout={
            "xaxis": axis(timeline.title),
            "yaxis": axis(title, rangemode="tozero"),
            "shapes": timeline.shapes(),
        },
        caption=thinning_note(max(len(part.t_start) for part in found), CURVE_POINTS),
        height=190,
        log_scale=True,
    )


def _trace(contents: Contents, part: Predictions, what: str, timeline: Timeline) -> dict[str, Any]:
    errors = part.position_error if what == "position" else part.heading_error * math.degrees(1.0)
    keep = thinned(len(errors))
    run, t = part.run[keep], part.t_start[keep]
    stroke = stroke_of(part.method, contents.evaluation.methods)
    unit = "m" if what == "position" else "°"
    return curve(
        with_breaks(run, timeline.at(run, t)),
        with_breaks(run, np.asarray(errors[keep])),
        mode="lines+markers",
        name=baseline_label(label(part.method, contents)),
        line={"color": stroke.colour, "dash": stroke.dash, "width": 1.5},
        marker={"color": stroke.colour, "symbol": stroke.symbol, "size": 5},
        hovertemplate=f"%{{fullData.name}}: %{{y:.3g}} {unit}<br>%{{x:.1f}} s<extra></extra>",
    )
