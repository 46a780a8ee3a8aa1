# SPDX-License-Identifier: Apache-2.0
"""How the parameters and the weights of the bases converged while driving."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.result import History
from slipwise.models.parameter_table import IDENTIFIED_FRACTION, physical_parameters
from slipwise.number_text import count_text, estimate_text
from slipwise.reporting.contents import PLAIN, Contents
from slipwise.reporting.figure import (
    SMALL_POINTS,
    Figure,
    axis,
    baseline_label,
    curve,
    thinned,
    vertical_lines,
)
from slipwise.reporting.markup import MINUS, details, grid, legend, missing, paragraph, table
from slipwise.reporting.palette import ALARM_COLOUR, Stroke, stroke_of, transparent
from slipwise.reporting.parameter_figures import parameter_figures
from slipwise.reporting.timeline import Timeline

_MOST_ALARMS = 6
_NO_SLIP = "no slip"  # the basis without terms, which is not the kinematic baseline: it has lag and delay
Floats = NDArray[np.float64]


class ConvergenceSection:
    """Did the parameters converge?"""

    title = "Parameters while learning"
    explanation = (
        "After every window learned, with a band of one standard deviation: it narrows where the log "
        "identifies the parameter."
    )

    def html(self, contents: Contents) -> str:
        """Return figures of the parameters that matter, all final values, and the weights of the bases."""
        model, history = contents.calibration.model, contents.calibration.history
        if not model.content.parameters:
            return missing("The model has no parameters: it predicts without slip.")
        values = details("All parameters of the model", _values(contents))
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
            + _weights(contents, history)
            + smoothed
            + values
        )


def _values(contents: Contents) -> str:
    """Return all parameters and limits in physical units, and what the log can hardly tell apart."""
    rows = [
        (
            parameter.name,
            estimate_text(parameter.value, parameter.std).replace("-", MINUS),
            parameter.unit,
            "yes" if parameter.identified else "no",
        )
        for parameter in physical_parameters(contents.calibration.model)
    ]
    html = table(("parameter", "value ± 1 sigma", "unit", "identified"), rows)
    note = (
        f"Identified: known to {100.0 * IDENTIFIED_FRACTION:.0f} % of the value, or known to be negligible."
    )
    pairs = ", ".join(map(str, contents.calibration.verdict.confounded))
    said = contents.calibration.verdict.force
    force = paragraph(said) if said else ""
    confounded = paragraph(f"Confounded parameters (correlation of their errors): {pairs}.") if pairs else ""
    return html + paragraph(f"{note} {contents.calibration.verdict.timing}".strip()) + force + confounded


def _alarms(contents: Contents, history: History) -> str:
    """Say when the terrain seemed to change."""
    alarms = history.alarms()
    if not alarms:
        return paragraph("No change of terrain was found.", kind="note")
    timeline = Timeline.of(contents.log)
    shown = ", ".join(f"{timeline.seconds(run, t):.1f} s" for run, t in alarms[:_MOST_ALARMS])
    more = f" and {len(alarms) - _MOST_ALARMS} more" if len(alarms) > _MOST_ALARMS else ""
    return paragraph(
        f"{count_text(len(alarms), 'change')} of terrain found, marked by an orange line: {shown}{more}. "
        "There, what was learned before counts less.",
        kind="note",
    )


def _alarm_marks(timeline: Timeline, history: History) -> list[dict[str, Any]]:
    """Return a vertical line where each change of terrain was found."""
    at = np.flatnonzero(history.alarm)
    return vertical_lines(timeline.at(history.run[at], history.t[at]).tolist(), ALARM_COLOUR)


def _parameters(contents: Contents, history: History) -> str:
    marks = _alarm_marks(Timeline.of(contents.log), history)
    drawn = parameter_figures(contents, history, key="parameter", marks=marks)
    return drawn or missing("The course of learning is not that of the model's parameters.")


def _smoothed(contents: Contents) -> str:
    """Draw what the parameters were at each time, given the whole log; an empty string if not wanted."""
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
    drawn, notes = [], []
    if len(history.bases) > 1:
        # The bases of an average are methods too and have their colours.
        methods = (*contents.evaluation.methods, *history.bases)
        strokes = {name: stroke_of(name, methods) for name in history.bases}
        shown = (strokes, history.basis_weight)
        drawn.append(_weights_figure(contents, history, ("weights", "slip bases"), shown))
        notes.append("A basis gains weight by how near its predictions come; the model is the weighted mean.")
    else:
        name = ", ".join(history.bases) or contents.calibration.model.motion.basis.name
        notes.append(f"One basis was used: {name}.")
    if history.structure_weight is not None:
        strokes = {name: stroke_of(name, history.structures) for name in history.structures}
        names = ("structures", "ways to explain the motion")
        drawn.append(_weights_figure(contents, history, names, (strokes, history.structure_weight)))
        heavier = history.structures[int(np.argmax(history.structure_weight[-1]))]
        notes.append(f"Predictions are those of the heavier way, at the end {heavier}, shown above.")
    figures = grid((f"<div>{figure}</div>" for figure in drawn), kind="wide-grid")
    notes_html = paragraph(" ".join(notes), kind="note")
    return (figures if drawn else "") + notes_html


def _weights_figure(
    contents: Contents, history: History, names: tuple[str, str], shown: tuple[dict[str, Stroke], Floats]
) -> str:
    """Draw weights [W, N] over time, stacked, the last in the legend; `names`: key and what is weighed."""
    key, what = names
    strokes, weights = shown
    timeline, keep = Timeline.of(contents.log), thinned(len(history.t), SMALL_POINTS)
    traces = [
        curve(
            timeline.at(history.run[keep], history.t[keep]),
            weights[keep, place].round(4),
            name=baseline_label(_NO_SLIP if name == PLAIN else name),
            stackgroup="weights",
            line={"color": stroke.colour, "width": 0.5},
            fillcolor=transparent(stroke.colour, 0.75),
            hovertemplate="%{fullData.name}: %{y:.2f}<br>%{x:.1f} s<extra></extra>",
        )
        for place, (name, stroke) in enumerate(strokes.items())
    ]
    figure = Figure(
        key=key,
        label=f"Weights of the {what} over time",
        heading=f"Weights of the {what}",
        traces=traces,
        layout={
            "xaxis": axis(timeline.title),
            "yaxis": axis("weight [-]", range=[0, 1]),
            "shapes": timeline.shapes() + _alarm_marks(timeline, history),
        },
        height=140,
    )
    last = zip(strokes.items(), weights[-1].tolist(), strict=True)
    keys = (
        (f"{_NO_SLIP if name == PLAIN else name} {weight:.2f}", stroke.colour, "line")
        for (name, stroke), weight in last
    )
    return legend(keys) + figure.html()
