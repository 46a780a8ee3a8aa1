# SPDX-License-Identifier: Apache-2.0
"""A strip of the drive coloured by surface, as high as the surface was probable, with alarms and recalls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.reporting.figure import (
    SMALL_POINTS,
    Figure,
    axis,
    baseline_label,
    curve,
    thinned,
    thinning_note,
    vertical_lines,
)
from slipwise.reporting.markup import legend
from slipwise.reporting.palette import ALARM_COLOUR, BAND, MEASURED, surface_colour, transparent

Floats = NDArray[np.float64]
UNNAMED = "not named"  # too short a visit to be remembered, or not decided
_MARK_HEIGHT = 1.06  # of the marks, on the axis of probabilities


@dataclass(frozen=True)
class GroundMark:
    """Something that was decided: where on the time axis [s], and what."""

    x: float
    text: str


@dataclass(frozen=True, eq=False)
class GroundStrip:
    """Surfaces along the time axis of a page."""

    x: Floats  # [W] s
    names: tuple[str, ...]  # [S]
    probability: Floats  # [W, S]
    alarms: tuple[float, ...]  # s
    marks: tuple[GroundMark, ...]
    boundaries: tuple[float, ...] = ()  # s, between drives


def strip_html(strip: GroundStrip, *, title: str) -> str:
    """Return the strip with its legend.

    Args:
        strip: what to draw.
        title: of the time axis, with its unit.
    """
    shares = strip.probability.sum(axis=0) / max(len(strip.x), 1)
    keys = [
        (f"{name} {100.0 * share:.0f} %", _colour(name, strip.names), "area")
        for name, share in zip(strip.names, shares.tolist(), strict=True)
    ]
    keys.append(("change of terrain found", ALARM_COLOUR, "line"))
    figure = Figure(
        key="ground",
        label="Surfaces along the drive and how probable they were",
        heading="Surface under the robot",
        traces=[*_areas(strip), _marks(strip)],
        layout={
            "xaxis": axis(title),
            "yaxis": axis("probability [-]", range=[0.0, 1.12], tickvals=[0, 0.5, 1]),
            "shapes": vertical_lines(strip.alarms, ALARM_COLOUR, yref="y")
            + vertical_lines(strip.boundaries, "#9aa5b1", dash="dot", yref="y"),
        },
        height=200,
        caption=thinning_note(len(strip.x), SMALL_POINTS),
    )
    return legend(keys) + figure.html()


def _colour(name: str, names: Sequence[str]) -> str:
    return BAND if name == UNNAMED else surface_colour(names.index(name))


def _areas(strip: GroundStrip) -> list[dict[str, Any]]:
    keep = thinned(len(strip.x), SMALL_POINTS)
    return [
        curve(
            strip.x[keep],
            strip.probability[keep, place].round(4),
            name=baseline_label(name),
            stackgroup="surfaces",
            line={"color": _colour(name, strip.names), "width": 0, "shape": "vh"},
            fillcolor=transparent(_colour(name, strip.names), 0.8),
            hovertemplate="%{fullData.name}: %{y:.2f}<br>%{x:.1f} s<extra></extra>",
        )
        for place, name in enumerate(strip.names)
    ]


def _marks(strip: GroundStrip) -> dict[str, Any]:
    return curve(
        [mark.x for mark in strip.marks],
        np.full(len(strip.marks), _MARK_HEIGHT),
        mode="markers",
        text=[baseline_label(mark.text) for mark in strip.marks],
        marker={"symbol": "triangle-down", "size": 9, "color": MEASURED},
        hovertemplate="%{text}<br>%{x:.1f} s<extra></extra>",
    )
