# SPDX-License-Identifier: Apache-2.0
"""The table of scores: methods by horizons, and all figures behind it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from slipwise.evaluation.result import ErrorSummary, Score, embargo_sentence
from slipwise.number_text import DASH
from slipwise.reporting.contents import MAIN_METHODS, Contents
from slipwise.reporting.markup import details, escape, missing, number, paragraph, scrolling
from slipwise.reporting.method_names import explanation, label
from slipwise.reporting.palette import css_swatch, stroke_of

_DEGREES = math.degrees(1.0)
# The columns' names, in lines.
_COMPARED = (("relative to", "the baseline"), ("to the best", "other method"))
_ALL_COLUMNS = (
    ("after", ""),
    ("mean [m],", "95 % interval"),
    *_COMPARED,
    ("mean [°],", "95 % interval"),
    *_COMPARED,
    ("NIS, band", "of its mean"),
    ("inside 50, 90,", "95 % ellipsoid"),
    ("in-sample:", "too optimistic"),
)

HAS_SEEN = "not causal: has seen these windows"


class ScoresSection:
    """How well does each method predict?"""

    title = "How far each method misses"
    explanation = (
        "Mean errors with 95 % intervals over the second half of the held-out windows, predicted from their "
        "inputs alone."
    )

    def html(self, contents: Contents) -> str:
        """Return the errors of the main methods, and every figure of every method folded away."""
        scores = contents.evaluation.scores
        if not scores:
            return missing("No window of the log could be scored, so there is no table.")
        present = [name for name in contents.evaluation.methods if any(s.method == name for s in scores)]
        main = [name for name in (*MAIN_METHODS, contents.learned_method) if name in present]
        shown = list(dict.fromkeys(main)) or present
        others = [name for name in present if name not in shown]
        folded = f"All figures{f', and {len(others)} other methods' if others else ''}"
        return (
            _main_table(contents, shown)
            + paragraph(embargo_sentence(contents.evaluation.embargo))
            + details(folded, _full_table(contents, [*shown, *others]) + _notes())
        )


def _horizons(contents: Contents) -> list[float]:
    return sorted({score.horizon for score in contents.evaluation.scores}, reverse=True)


def _main_table(contents: Contents, methods: Sequence[str]) -> str:
    horizons = _horizons(contents)
    groups = [("method", 1, True)] + [
        (f"after {horizon:g} s ({_windows(contents, horizon)} windows)", 2, False) for horizon in horizons
    ]
    names = ["position [m]", "heading [°]"] * len(horizons)
    rows = []
    for method in methods:
        cells = []
        for horizon in horizons:
            score = contents.score(method, horizon)
            cells += (
                [DASH, DASH]
                if score is None
                else [
                    _error(score.position, 1.0),
                    _error(score.heading, _DEGREES),
                ]
            )
        rows.append(_row(contents, method, cells))
    return _table(groups, names, rows)


def _windows(contents: Contents, horizon: float) -> str:
    counts = {score.windows for score in contents.evaluation.scores if score.horizon == horizon}
    return ", ".join(map(str, sorted(counts)))


def _full_table(contents: Contents, methods: Sequence[str]) -> str:
    groups = [
        ("method", 1, True),
        ("", 1, False),
        ("position error", 3, False),
        ("heading error", 3, False),
        ("covariance", 2, False),
        ("residual", 1, False),
    ]
    names = ["<br>".join(map(escape, lines)) for lines in _ALL_COLUMNS]
    rows = [
        _row(contents, method, _cells(score))
        for horizon in _horizons(contents)
        for method in methods
        if (score := contents.score(method, horizon)) is not None
    ]
    return _table(groups, names, rows)


def _table(groups: Iterable[tuple[str, int, bool]], names: Sequence[str], rows: Sequence[str]) -> str:
    """Return a table of rows below (heading of columns, how many, whether over both lines)."""
    first = "".join(
        f'<th rowspan="2" class="corner" scope="col">{escape(text)}</th>'
        if both
        else f'<th colspan="{count}" class="group" scope="colgroup">{escape(text)}</th>'
        for text, count, both in groups
    )
    second = "".join(f'<th scope="col">{name}</th>' for name in names)
    return scrolling(
        f'<table class="scores"><thead><tr>{first}</tr><tr>{second}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _row(contents: Contents, method: str, cells: Sequence[str]) -> str:
    colour = stroke_of(method, contents.evaluation.methods).colour
    ours = ' class="ours"' if method == contents.learned_method else ""
    causal = all(score.causal for score in contents.evaluation.scores if score.method == method)
    words = [explanation(method, contents), "" if causal else HAS_SEEN]
    small = "".join(_small(text) for text in words if text)
    return (
        f'<tr{ours}><th scope="row"><span class="swatch" style="{css_swatch(colour)}"></span>'
        f"{escape(label(method, contents))}{small}</th>"
        + "".join(f"<td>{cell}</td>" for cell in cells)
        + "</tr>"
    )


def _cells(score: Score) -> tuple[str, ...]:
    in_sample = f"{number(score.in_sample_position)} m, {number(score.in_sample_heading * _DEGREES)}°"
    return (
        f"{score.horizon:g} s",
        _error(score.position, 1.0),
        _interval(score.position_ratio),
        number(score.position_to_rival, 2),
        _error(score.heading, _DEGREES),
        _interval(score.heading_ratio),
        number(score.heading_to_rival, 2),
        number(score.nis) + _small(f"{number(score.nis_band[0])} to {number(score.nis_band[1])}"),
        ", ".join(_percent(fraction) for fraction in score.coverage) + " %",
        f'<span class="caution">{escape(in_sample)}</span>',
    )


def _error(summary: ErrorSummary, scale: float) -> str:
    if summary.mean == summary.high == 0.0:  # nothing was measured
        return DASH
    low, high = number(summary.low * scale), number(summary.high * scale)
    return number(summary.mean * scale) + _small(f"{low} to {high}")


def _interval(ratio: tuple[float, float, float]) -> str:
    value, low, high = ratio
    if not math.isfinite(value):
        return DASH
    return number(value, 2) + _small(f"{number(low, 2)} to {number(high, 2)}")


def _small(text: str) -> str:
    return f"<small>{escape(text)}</small>"


def _percent(fraction: float) -> str:
    return f"{100.0 * fraction:.0f}" if math.isfinite(fraction) else DASH


def _notes() -> str:
    return paragraph(
        "A ratio below 1 is better. NIS is the normalised innovation squared, 3 where the predicted "
        "covariance is true. In-sample: the error of a window predicted again after it was learned, as the "
        "thesis has it.",
        kind="explanation",
    )
