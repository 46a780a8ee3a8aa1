# SPDX-License-Identifier: Apache-2.0
"""How the parameters and the weights of the bases settled while driving."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.result import History
from slipwise.models.limits import limit_rows
from slipwise.models.model import Model
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import Figure, axis, numbers, plain_label
from slipwise.reporting.markup import details, legend, missing, number, paragraph, table
from slipwise.reporting.palette import ALARM_COLOUR, Stroke, stroke_of, transparent
from slipwise.reporting.parameter_figures import parameter_figures
from slipwise.reporting.thinning import thinned
from slipwise.reporting.timeline import Timeline

_MOST_ALARMS = 6
Floats = NDArray[np.float64]


class ConvergenceSection:
    """Did the parameters settle?"""

    title = "Parameters while learning"
    explanation = (
        "Each parameter after every window learned, with a band of one standard deviation: what is "
        "determined settles and its band narrows."
    )

    def html(self, contents: Contents) -> str:
        """Return figures of the parameters that matter, all final values, and the weights of the bases."""
        model, history = contents.calibration.model, contents.calibration.history
        if not model.content.parameters:
            return missing("The model has no parameters: it predicts without slip.")
        values = details("All parameters of the model", _values(model))
        smoothed = _smoothed(contents)
        if history is None:
            return (
                missing("The model was fitted to the whole log at once, so there is no course of learning.")
                + smoothed
                + values
            )
        if not len(history.t):
            return missing("No window was learned, so the parameters are still the prior.") + values
        return (
            _parameters(contents, history)
            + _alarms(contents, history)
            + smoothed
            + values
            + _weights(contents, history)
        )


_VALUE_COLUMNS = (
    "parameter",
    "unit",
    "value",
    "± 1 sigma",
    "± before any data",
    "share left",
    "determined",
)


def _values(model: Model) -> str:
    rows = [
        (
            parameter.name,
            parameter.unit,
            number(parameter.value, 4),
            number(parameter.std, 2),
            number(parameter.prior_std, 2),
            number(parameter.std / parameter.prior_std, 2) if parameter.prior_std > 0.0 else "",
            "yes" if parameter.determined else "no",
        )
        for parameter in model.content.parameters
    ]
    html = table(_VALUE_COLUMNS, rows)
    if model.content.limits is None:
        return html
    limits = [
        (name, unit, number(value, 4), number(std, 2))
        for name, value, std, unit in limit_rows(model.content.limits)
    ]
    return html + table(("limit of the drive", "unit", "value", "± 1 sigma"), limits)


def _alarms(contents: Contents, history: History) -> str:
    """Say when the ground seemed to change."""
    alarms = history.alarms()
    if not alarms:
        return paragraph("No change of ground was found.")
    names = [run.name for run in contents.log.runs]
    shown = ", ".join(f"{t:.1f} s of {names[run] or f'run {run}'}" for run, t in alarms[:_MOST_ALARMS])
    more = f" and {len(alarms) - _MOST_ALARMS} more" if len(alarms) > _MOST_ALARMS else ""
    return paragraph(
        f"The ground seems to change {len(alarms)} time{'s' if len(alarms) > 1 else ''}, marked by an orange "
        f"line: at {shown}{more}. There, what was learned before counts less."
    )


def _alarm_marks(timeline: Timeline, history: History) -> list[dict[str, Any]]:
    """Return a vertical line where each change of ground was found."""
    at = np.flatnonzero(history.alarm)
    line = {"color": ALARM_COLOUR, "width": 1.5}
    return [
        {"type": "line", "xref": "x", "yref": "paper", "x0": x, "x1": x, "y0": 0, "y1": 1, "line": line}
        for x in timeline.at(history.run[at], history.t[at]).tolist()
    ]


def _parameters(contents: Contents, history: History) -> str:
    marks = _alarm_marks(Timeline.of(contents.log), history)
    drawn = parameter_figures(contents, history, key="parameter", marks=marks)
    return drawn or missing("The course of learning is not that of the model's parameters.")


def _smoothed(contents: Contents) -> str:
    """Draw what the parameters were at each time, given the whole log; nothing where it was not asked for."""
    course = contents.calibration.smoothed
    if course is None:
        return ""
    return paragraph(
        "The slip smoothed over the whole log, for slip that changes slowly: each value knows what came "
        "before and after it, so nothing is predicted with it. Where a band is as wide as before any data, "
        "the drive there says nothing of the parameter."
    ) + parameter_figures(contents, course, key="smoothed")


def _weights(contents: Contents, history: History) -> str:
    """Draw the weights of the bases, and of the ways to learn from commands, where there are several."""
    if history.structure_weight is None:
        return _basis_weights(contents, history)
    strokes = {name: stroke_of(name, history.structures) for name in history.structures}
    shown = (strokes, history.structure_weight)
    heavier = history.structures[int(np.argmax(history.structure_weight[-1]))]
    note = f"Predictions are those of the heavier way, at the end {heavier}, which this section shows."
    figure = _weights_figure(contents, history, ("structures", "ways to explain the motion"), shown)
    return _basis_weights(contents, history) + figure + paragraph(note)


def _basis_weights(contents: Contents, history: History) -> str:
    if len(history.bases) < 2:
        return paragraph(
            f"One basis was used: {', '.join(history.bases) or contents.calibration.model.motion.basis.name}."
        )
    # The bases of an average are methods too and have their colours.
    strokes = {
        name: stroke_of(name, (*contents.evaluation.methods, *history.bases)) for name in history.bases
    }
    figure = _weights_figure(contents, history, ("weights", "slip bases"), (strokes, history.basis_weight))
    return figure + paragraph(
        "A basis gains weight by how near its predictions come; after each window a share is dealt out "
        "evenly. The model is the weighted mean."
    )


def _weights_figure(
    contents: Contents, history: History, names: tuple[str, str], shown: tuple[dict[str, Stroke], Floats]
) -> str:
    """Draw weights [W, N] over time, stacked, the last in the legend; `names`: key and what is weighed."""
    key, what = names
    strokes, weights = shown
    timeline, keep = Timeline.of(contents.log), thinned(len(history.t))
    traces = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": plain_label(name),
            "x": numbers(timeline.at(history.run[keep], history.t[keep])),
            "y": numbers(weights[keep, place]),
            "stackgroup": "weights",
            "line": {"color": stroke.colour, "width": 0.5},
            "fillcolor": transparent(stroke.colour, 0.75),
            "hovertemplate": "%{fullData.name}: %{y:.2f}<br>%{x:.1f} s<extra></extra>",
        }
        for place, (name, stroke) in enumerate(strokes.items())
    ]
    figure = Figure(
        key=key,
        label=f"Weights of the {what} over time",
        heading=f"Weights of the {what}",
        traces=traces,
        layout={
            "xaxis": axis(timeline.title),
            "yaxis": axis("weight, together 1 [-]", range=[0, 1]),
            "shapes": timeline.shapes() + _alarm_marks(timeline, history),
        },
        height=280,
    )
    last = zip(strokes.items(), weights[-1].tolist(), strict=True)
    keys = ((f"{name} {weight:.2f}", stroke.colour, "line") for (name, stroke), weight in last)
    return legend(keys) + figure.html()
