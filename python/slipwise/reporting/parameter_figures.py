# SPDX-License-Identifier: Apache-2.0
"""Parameters over time with their one-sigma bands, those first that explain most of the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from slipwise.models.parameter_table import physical_name, physical_parameters
from slipwise.models.schema import Parameter
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import (
    SMALL_POINTS,
    Figure,
    axis,
    baseline_label,
    curve,
    thinned,
    thinning_note,
)
from slipwise.reporting.markup import details, grid, legend, number, paragraph
from slipwise.reporting.palette import LEARNED_STROKE, transparent
from slipwise.reporting.timeline import Timeline, with_breaks

_MOST_PARAMETERS = 12
_SHOWN_AT_ONCE = 5  # the others are folded away
Floats = NDArray[np.float64]


class Course(Protocol):
    """Parameters over time: a history, or a smoothed course."""

    @property
    def run(self) -> NDArray[np.int64]:
        """Index of the run in the log, [W]."""
        ...

    @property
    def t(self) -> Floats:
        """When, in the run's clock, [W] s."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Parameter names, [P]."""
        ...

    @property
    def mean(self) -> Floats:
        """Parameters, [W, P]."""
        ...

    @property
    def std(self) -> Floats:
        """Their standard deviations, [W, P]."""
        ...


def parameter_figures(
    contents: Contents, course: Course, *, key: str, marks: Sequence[dict[str, Any]] = ()
) -> str:
    """Draw the parameters that matter; empty where the course is not that of the model's parameters.

    Args:
        contents: the report.
        course: what to draw.
        key: what the figures' ids start with.
        marks: shapes to draw over each figure.
    """
    model = contents.calibration.model
    known = {row.name: row for row in model.vector.rows}
    slip = model.vector.names[: model.motion.slip_size]
    names = _chosen(known, course.names, slip)
    if not names:
        return ""
    physical = {p.name: p for p in physical_parameters(model)}
    identified = {name for name in known if physical[physical_name(name)].identified}
    figures = [
        _figure(contents, course, (known[name], name in identified), (f"{key}-{place}", list(marks))).html()
        for place, name in enumerate(names, start=1)
    ]
    left = len(known) - len(figures)
    keys = (
        ("value, its end below", LEARNED_STROKE.colour, "line"),
        ("± 1 sigma", LEARNED_STROKE.colour, "area"),
    )
    more = f"; {left} more are in the table" if left > 0 else ""
    note = (
        f"Ordered by how much of the motion they explain{more}. {thinning_note(len(course.t), SMALL_POINTS)}"
    )
    rest = figures[_SHOWN_AT_ONCE:]
    folded = details(f"{len(rest)} more parameters", grid(rest, kind="fine-grid")) if rest else ""
    return (
        legend(keys)
        + grid(figures[:_SHOWN_AT_ONCE], kind="fine-grid")
        + folded
        + paragraph(note.strip(), kind="note")
    )


def _order(parameter: Parameter) -> tuple[bool, float]:
    """Determined slip first, by value over prior: the prior is a fraction of the motion."""
    fraction = abs(parameter.value) / parameter.prior_std if parameter.prior_std > 0.0 else 0.0
    return not parameter.identifiable, -fraction


def _chosen(known: dict[str, Parameter], names: tuple[str, ...], slip: list[str]) -> list[str]:
    """Choose the slip parameters that explain most, and those of lag, delay and clock."""
    actuator = [name for name in names if name in known and name not in slip]
    slip = sorted((name for name in names if name in slip), key=lambda name: _order(known[name]))
    return slip[: max(_MOST_PARAMETERS - len(actuator), 1)] + actuator[:_MOST_PARAMETERS]


def _figure(
    contents: Contents, course: Course, what: tuple[Parameter, bool], label: tuple[str, list[dict[str, Any]]]
) -> Figure:
    (parameter, identified), (key, marks) = what, label
    timeline, column = Timeline.of(contents.log), course.names.index(parameter.name)
    keep = thinned(len(course.t), SMALL_POINTS)
    run = course.run[keep]
    x = timeline.at(run, course.t[keep])
    shown = _Shown.of(parameter)
    mean, std = course.mean[keep, column], course.std[keep, column]
    value = curve(
        with_breaks(run, x),
        with_breaks(run, shown.values(mean)),
        mode="lines" if len(keep) > 1 else "markers",
        line={"color": LEARNED_STROKE.colour, "width": 2},
        hovertemplate="%{y:.4g}<br>%{x:.1f} s<extra></extra>",
    )
    return Figure(
        key=key,
        label=f"Parameter {shown.name} over time",
        heading=shown.name + ("" if identified else " (not identified)"),
        traces=[_band(x, shown.values(mean - std), shown.values(mean + std)), value],
        layout={
            "xaxis": axis(timeline.title, nticks=6, small=True),
            "yaxis": axis(f"[{baseline_label(shown.unit)}]", nticks=5, small=True),
            "shapes": timeline.shapes() + marks,
        },
        height=142,
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
        name = physical_name(parameter.name)
        if name != parameter.name:
            return cls(name, "s", True)
        return cls(name, parameter.unit or "-", False)

    def values(self, values: Floats) -> Floats:
        return np.exp(values) if self.exponential else values

    def final(self, parameter: Parameter) -> str:
        if not self.exponential:
            return f"{number(parameter.value)} ± {number(parameter.std, 2)} {self.unit}"
        spread = parameter.std * np.array([0.0, -1.0, 1.0])
        value, low, high = self.values(parameter.value + spread).tolist()
        return f"{number(value)} {self.unit}, ± 1 sigma: {number(low)} to {number(high)}"


def _band(x: Floats, low: Floats, high: Floats) -> dict[str, Any]:
    return curve(
        np.concatenate((x, x[::-1])),
        np.concatenate((high, low[::-1])),
        fill="toself",
        fillcolor=transparent(LEARNED_STROKE.colour, 0.2),
        line={"width": 0},
        hoverinfo="skip",
    )
