# SPDX-License-Identifier: Apache-2.0
"""Whether the reported uncertainty is true: the normalised innovation squared over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.statistics import nis_band
from slipwise.evaluation.result import Predictions
from slipwise.reporting.contents import Contents
from slipwise.reporting.figure import Figure, axis, curve, numbers, thinned, thinning_note
from slipwise.reporting.markup import grid, legend, missing, paragraph
from slipwise.reporting.method_names import label
from slipwise.reporting.palette import LEARNED_STROKE, MEASURED, transparent
from slipwise.reporting.timeline import Timeline
from slipwise.reporting.uncertainty import honesty_of
from slipwise.student import ellipsoid_squared

_MEAN_OVER = 20  # windows of the moving mean
_TRUE_MEAN = 3.0  # of the NIS of x, y, yaw
# 2.5 and 97.5 % quantiles of chi-square with 3 degrees of freedom, from tables.
_NORMAL_BAND = (0.2157952826, 9.3484036045)
_BAND_ENDS = (0.025, 0.975)
_MEAN_COLOUR = "#b8860b"
_MEAN_BAND = "#e6d6ad"  # the same on the paper with an opacity of 0.35
Floats = NDArray[np.float64]


class NisSection:
    """Is the predicted covariance true?"""

    title = "Is the reported uncertainty true?"
    explanation = (
        "NIS, the normalised innovation squared, is 3 on average where the covariance is true, more "
        "where it is too small."
    )

    def html(self, contents: Contents) -> str:
        """Return the NIS of the scored predictions and of the filter's own windows."""
        timeline = Timeline.of(contents.log)
        figures = []
        predictions = contents.predictions(contents.learned_method, contents.longest_horizon)
        if predictions is not None:
            heading = f"Predictions of {label(predictions.method, contents)} over {predictions.horizon:g} s"
            place = timeline.at(predictions.run, predictions.t_start)
            band = _band_of(predictions)
            figures.append(_figure(timeline, _Series("predictions", heading, place, _nis(predictions), band)))
        history = contents.calibration.history
        if history is not None and len(history.t):
            heading = "Windows before they were learned"
            place = timeline.at(history.run, history.t)
            figures.append(_figure(timeline, _Series("learning", heading, place, history.nis, _NORMAL_BAND)))
        drawn = [figure for figure in figures if figure is not None]
        if not drawn:
            return missing("No window has a predicted covariance, so its truth cannot be judged.")
        return _answer(contents) + _legend() + grid((figure.html() for figure in drawn), kind="wide-grid")


def _answer(contents: Contents) -> str:
    honesty = honesty_of(contents.score(contents.learned_method, contents.longest_horizon))
    return "" if honesty is None else paragraph(honesty.sentence, kind="answer")


def _legend() -> str:
    return legend(
        (
            ("one window", LEARNED_STROKE.colour, "mark"),
            ("95 % of the windows", LEARNED_STROKE.colour, "area"),
            (f"mean of the last {_MEAN_OVER}", MEASURED, "line"),
            ("95 % of such means", _MEAN_COLOUR, "area"),
            ("3", "#566270", "dot"),
        )
    )


def _band_of(predictions: Predictions) -> tuple[float, float]:
    """Where the NIS of 95 % of the windows should lie, for the middle of their degrees of freedom."""
    low, high = (ellipsoid_squared(fraction, float(np.median(predictions.dof))) for fraction in _BAND_ENDS)
    return low, high


def _nis(predictions: Predictions) -> Floats:
    """Return the NIS of each window [N], NaN where the covariances cannot be inverted."""
    try:
        return predictions.nis
    except np.linalg.LinAlgError:
        return np.full(len(predictions), np.nan)


@dataclass(frozen=True, eq=False)
class _Series:
    """What one figure shows, [N]."""

    key: str
    heading: str
    x: Floats  # place on the timeline
    nis: Floats
    band: tuple[float, float]  # where 95 % of the windows should lie


def _figure(timeline: Timeline, series: _Series) -> Figure | None:
    good = np.isfinite(series.nis) & (series.nis > 0.0)
    if not good.any():
        return None
    x, y, heading, band = series.x[good], series.nis[good], series.heading, series.band
    keep = thinned(len(y))
    low, high = nis_band(min(_MEAN_OVER, len(y)))
    outside = float(np.mean((y < band[0]) | (y > band[1])))
    exponents = np.log10([min(float(y.min()), 0.1), max(float(y.max()), 20.0)])
    fraction = f"{100.0 * outside:.0f} % lie outside their band (5 % expected)"
    caption = f"Mean of all {len(y)} windows {y.mean():.2f}; {fraction}."
    return Figure(
        key=f"nis-{series.key}",
        label=f"{heading}: normalised innovation squared over time",
        heading=heading,
        traces=[_dots(x[keep], y[keep]), *_mean_line(x, y)],
        layout={
            "xaxis": axis(timeline.title),
            "yaxis": axis(
                "NIS [-], log scale",
                type="log",
                range=numbers([exponents[0] - 0.1, exponents[1] + 0.1]),
                dtick=1,
            ),
            "shapes": [
                *_band(*band, transparent(LEARNED_STROKE.colour, 0.13)),
                *_band(low, high, _MEAN_BAND),
                _level(_TRUE_MEAN),
                *timeline.shapes(),
            ],
        },
        height=180,
        caption=f"{caption} {thinning_note(len(y))}".strip(),
    )


def _dots(x: Floats, y: Floats) -> dict[str, Any]:
    return curve(
        x,
        y,
        mode="markers",
        marker={"color": LEARNED_STROKE.colour, "size": 5, "opacity": 0.7},
        hovertemplate="NIS %{y:.2f}<br>%{x:.1f} s<extra></extra>",
    )


def _mean_line(x: Floats, y: Floats) -> list[dict[str, Any]]:
    """The moving mean, from the window on where it has all its members."""
    if len(y) < _MEAN_OVER:
        return []
    mean = np.convolve(y, np.full(_MEAN_OVER, 1.0 / _MEAN_OVER), mode="valid")
    keep = thinned(len(mean))
    return [
        curve(
            x[_MEAN_OVER - 1 :][keep],
            mean[keep],
            line={"color": MEASURED, "width": 2},
            hovertemplate=f"mean of {_MEAN_OVER}: %{{y:.2f}}<br>%{{x:.1f}} s<extra></extra>",
        )
    ]


def _band(low: float, high: float, colour: str) -> list[dict[str, Any]]:
    return [
        {
            "type": "rect",
            "xref": "paper",
            "yref": "y",
            "x0": 0,
            "x1": 1,
            "y0": low,
            "y1": high,
            "fillcolor": colour,
            "line": {"width": 0},
            "layer": "below",
        }
    ]


def _level(y: float) -> dict[str, Any]:
    line = {"color": "#566270", "width": 1.5, "dash": "dot"}
    return {"type": "line", "xref": "paper", "yref": "y", "x0": 0, "x1": 1, "y0": y, "y1": y, "line": line}
