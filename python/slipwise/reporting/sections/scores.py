# SPDX-License-Identifier: Apache-2.0
"""The table of scores: methods by horizons, with intervals, ratios, and how honest the covariance is."""

from __future__ import annotations

import math
from collections.abc import Sequence

from slipwise.evaluation.result import ErrorSummary, Score
from slipwise.number_text import DASH
from slipwise.reporting.contents import MAIN_METHODS, Contents
from slipwise.reporting.markup import details, escape, missing, number, scrolling
from slipwise.reporting.palette import stroke_of

_DEGREES = math.degrees(1.0)
# The columns' names, in lines.
_COMPARED = (
    ("relative", "to none"),
    ("to best", "rival"),
    ("thesis-style,", "in-sample:", "too optimistic"),
)
_COLUMNS = (
    ("mean [m],", "95 % interval"),
    *_COMPARED,
    ("mean [°],", "95 % interval"),
    *_COMPARED,
    ("NIS, band", "of its mean"),
    ("inside 50, 90,", "95 % ellipsoid"),
)


class ScoresSection:
    """How well does each method predict?"""

    title = "How far the predictions are off"
    explanation = (
        "Mean errors of predictions made from the commands or wheel speeds alone, with nothing measured "
        "after their start; smaller is better, and a ratio below 1 beats its rival."
    )

    def html(self, contents: Contents) -> str:
        """Return one table per horizon, the longest first, the main methods before the others."""
        horizons = sorted({score.horizon for score in contents.evaluation.scores}, reverse=True)
        if not horizons:
            return missing("No window of the log could be scored, so there is no table.")
        return "".join(self._horizon(contents, horizon) for horizon in horizons) + _notes(contents)

    def _horizon(self, contents: Contents, horizon: float) -> str:
        scores = [score for score in contents.evaluation.scores if score.horizon == horizon]
        main = [score for name in MAIN_METHODS for score in scores if score.method == name]
        shown = main or scores
        others = [score for score in scores if score not in shown]
        windows = ", ".join(sorted({str(score.windows) for score in scores}, key=int))
        html = f"<h3>{escape(f'After {horizon:g} s ({windows} windows)')}</h3>" + _table(shown, contents)
        if others:
            html += details(f"Other methods after {horizon:g} s ({len(others)})", _table(others, contents))
        return html


def _table(scores: Sequence[Score], contents: Contents) -> str:
    groups = (
        '<tr><th rowspan="2" class="corner" scope="col">method</th>'
        '<th colspan="4" class="group" scope="colgroup">position error</th>'
        '<th colspan="4" class="group" scope="colgroup">heading error</th>'
        '<th colspan="2" class="group" scope="colgroup">covariance</th></tr>'
    )
    names = "".join(f'<th scope="col">{"<br>".join(lines)}</th>' for lines in _COLUMNS)
    rows = "".join(_row(score, contents) for score in scores)
    return scrolling(
        f'<table class="scores"><thead>{groups}<tr>{names}</tr></thead><tbody>{rows}</tbody></table>'
    )


def _row(score: Score, contents: Contents) -> str:
    colour = stroke_of(score.method, contents.evaluation.methods).colour
    ours = ' class="ours"' if score.method == contents.learned_method else ""
    mark = "" if score.causal else "<small>not causal: has<br>seen these windows</small>"
    cells = (
        _error(score.position, 1.0),
        _interval(score.position_ratio),
        number(score.position_to_rival, 2),
        f'<span class="caution">{number(score.in_sample_position)}</span>',
        _error(score.heading, _DEGREES),
        _interval(score.heading_ratio),
        number(score.heading_to_rival, 2),
        f'<span class="caution">{number(score.in_sample_heading * _DEGREES)}</span>',
        number(score.nis) + _small(f"{number(score.nis_band[0])} to {number(score.nis_band[1])}"),
        ", ".join(_percent(share) for share in score.coverage) + " %",
    )
    return (
        f'<tr{ours}><th scope="row"><span class="swatch" style="background:{colour}"></span>'
        f"{escape(score.method)}{mark}</th>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
    )


def _error(summary: ErrorSummary, scale: float) -> str:
    low, high = number(summary.low * scale), number(summary.high * scale)
    return number(summary.mean * scale) + _small(f"{low} to {high}")


def _interval(ratio: tuple[float, float, float]) -> str:
    value, low, high = ratio
    if not math.isfinite(value):
        return DASH
    return number(value, 2) + _small(f"{number(low, 2)} to {number(high, 2)}")


def _small(text: str) -> str:
    return f"<small>{escape(text)}</small>"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f}" if math.isfinite(share) else DASH


def _notes(contents: Contents) -> str:
    source = "wheel speeds" if contents.evaluation.input == "wheel" else "commands"
    return (
        f'<p class="explanation"><b>none</b> follows the {source} without any slip, <b>vendor</b> turns by '
        "the maker's track multiplier, <b>edd-2</b> fits two numbers (speed and yaw rate), <b>auto</b> is "
        "slipwise. The scores are over the second half of the windows. The best rival is the best other "
        "method than none. NIS is the normalised innovation squared: 3 where the predicted covariance is "
        "true.</p>"
    )
