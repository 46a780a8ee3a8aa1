# SPDX-License-Identifier: Apache-2.0
"""How the parameters and the weights of the bases settled while driving."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.result import History
from slipwise.models.limits import limit_rows
from slipwise.models.model import Model
from slipwise.models.schema import Parameter
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import Figure, axis, numbers, plain_label
from slipwise.reporting.markup import details, legend, missing, number, paragraph, table
from slipwise.reporting.palette import ALARM_COLOUR, LEARNED_STROKE, Stroke, stroke_of, transparent
from slipwise.reporting.thinning import CURVE_POINTS, thinned, thinning_note
from slipwise.reporting.timeline import Timeline, with_breaks

_MOST_PARAMETERS = 12
_MOST_ALARMS = 6
_LOGARITHM = "log_"  # lags and delays are learned as logarithms and shown in seconds
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
        if history is None:
            return (
                missing("The model was fitted to the whole log at once, so there is no course of learning.")
                + values
            )
        if not len(history.t):
            return missing("No window was learned, so the parameters are still the prior.") + values
        return (
            _parameters(contents, history) + _alarms(contents, history) + values + _weights(contents, history)
        )


def _values(model: Model) -> str:
    rows = [
        (
            parameter.name,
            parameter.unit,
            number(parameter.value, 4),
            number(parameter.std, 2),
            number(parameter.prior_std, 2),
            "yes" if parameter.determined else "no",
        )
        for parameter in model.content.parameters
    ]
    html = table(("parameter", "unit", "value", "± 1 sigma", "± before any data", "determined"), rows)
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


def _order(parameter: Parameter) -> tuple[bool, float]:
    """Determined slip first, by value over prior: the prior is a share of the motion."""
    share = abs(parameter.value) / parameter.prior_std if parameter.prior_std > 0.0 else 0.0
    return not parameter.determined, -share


def _chosen(known: dict[str, Parameter], names: tuple[str, ...], slip: list[str]) -> list[str]:
    """Choose the slip parameters that explain most, and those of lag, delay and clock."""
    chain = [name for name in names if name in known and name not in slip]
    slip = sorted((name for name in names if name in slip), key=lambda name: _order(known[name]))
    return slip[: max(_MOST_PARAMETERS - len(chain), 1)] + chain[:_MOST_PARAMETERS]


def _parameters(contents: Contents, history: History) -> str:
    model = contents.calibration.model
    known = {parameter.name: parameter for parameter in model.content.parameters}
    slip = [parameter.name for parameter in model.content.parameters[: model.motion.slip_size]]
    names = _chosen(known, history.names, slip)
    if not names:
        return missing("The course of learning is not that of the model's parameters.")
    figures = [
        _figure(contents, history, known[name], place).html() for place, name in enumerate(names, start=1)
    ]
    left = len(known) - len(figures)
    keys = (("value", LEARNED_STROKE.colour, "line"), ("± 1 sigma", LEARNED_STROKE.colour, "area"))
    more = f"; {left} more are in the table" if left > 0 else ""
    note = f"Ordered by how much of the motion they explain{more}."
    thinning = thinning_note(len(history.t))
    return (
        legend(keys) + f'<div class="grid">{"".join(figures)}</div>' + paragraph(f"{note} {thinning}".strip())
    )


def _figure(contents: Contents, history: History, parameter: Parameter, place: int) -> Figure:
    timeline, column = Timeline.of(contents.log), history.names.index(parameter.name)
    keep = thinned(len(history.t), CURVE_POINTS)
    run = history.run[keep]
    x = timeline.at(run, history.t[keep])
    shown = _Shown.of(parameter)
    mean, std = history.mean[keep, column], history.std[keep, column]
    value = {
        "type": "scatter",
        "mode": "lines" if len(keep) > 1 else "markers",
        "x": numbers(with_breaks(run, x)),
        "y": numbers(with_breaks(run, shown.values(mean))),
        "line": {"color": LEARNED_STROKE.colour, "width": 2},
        "hovertemplate": "%{y:.4g}<br>%{x:.1f} s<extra></extra>",
    }
    return Figure(
        key=f"parameter-{place}",
        label=f"Parameter {parameter.name} while learning",
        heading=shown.name + ("" if parameter.determined else " (not determined)"),
        traces=[_band(x, shown.values(mean - std), shown.values(mean + std)), value],
        layout={
            "xaxis": axis(timeline.title, nticks=6),
            "yaxis": axis(f"[{plain_label(shown.unit)}]", nticks=6),
            "shapes": timeline.shapes() + _alarm_marks(timeline, history),
        },
        height=240,
        caption=shown.final(parameter),
    )


@dataclass(frozen=True)
class _Shown:
    """How a parameter is shown: its name, unit, and whether its exponential is."""

    name: str
    unit: str
    exponential: bool

    @classmethod
    def of(cls, parameter: Parameter) -> _Shown:
        if parameter.name.startswith(_LOGARITHM):
            return cls(parameter.name.removeprefix(_LOGARITHM), "s", True)
        return cls(parameter.name, parameter.unit or "-", False)

    def values(self, values: Floats) -> Floats:
        return np.exp(values) if self.exponential else values

    def final(self, parameter: Parameter) -> str:
        if not self.exponential:
            return f"Final value {number(parameter.value)} ± {number(parameter.std, 2)} {self.unit}"
        spread = parameter.std * np.array([0.0, -1.0, 1.0])
        value, low, high = self.values(parameter.value + spread).tolist()
        return f"Final value {number(value)} {self.unit}, ± 1 sigma: {number(low)} to {number(high)}"


def _band(x: Floats, low: Floats, high: Floats) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(np.concatenate((x, x[::-1]))),
        "y": numbers(np.concatenate((high, low[::-1]))),
        "fill": "toself",
        "fillcolor": transparent(LEARNED_STROKE.colour, 0.2),
        "line": {"width": 0},
        "hoverinfo": "skip",
    }


def _weights(contents: Contents, history: History) -> str:
    if len(history.bases) < 2:
        return paragraph(
            f"One basis was used: {', '.join(history.bases) or contents.calibration.model.motion.basis.name}."
        )
    # The bases of an average are methods too and have their colours.
    strokes = {
        name: stroke_of(name, (*contents.evaluation.methods, *history.bases)) for name in history.bases
    }
    html = _weights_figure(contents, history, ("weights", "slip bases"), (strokes, history.basis_weight))
    if history.structure_weight is None:
        return html
    strokes = {name: stroke_of(name, history.structures) for name in history.structures}
    shown = (strokes, history.structure_weight)
    return html + _weights_figure(contents, history, ("structures", "ways to learn from commands"), shown)


def _weights_figure(
    contents: Contents, history: History, names: tuple[str, str], shown: tuple[dict[str, Stroke], Floats]
) -> str:
    """Draw weights [W, N] over time, stacked; `names` are the figure's key and what is weighed."""
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
    return legend((name, stroke.colour, "line") for name, stroke in strokes.items()) + figure.html()
