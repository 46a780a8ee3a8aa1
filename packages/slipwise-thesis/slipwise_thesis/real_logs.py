# SPDX-License-Identifier: Apache-2.0
"""Surfaces and on-line estimators side by side on the real logs of a Husky and a Warthog."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from slipwise.number_text import DASH, number_text
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import Bars, Panel
from slipwise_thesis.real_log_scores import (
    FEWEST_WINDOWS,
    HUSKY,
    INPUTS,
    METHODS,
    ON_LINE,
    SURFACES,
    LogScores,
    MeanRatios,
    log_scores,
    mean_ratios,
    warthog_names,
)
from slipwise_thesis.slip_surfaces import LARGEST_PROCESS
from slipwise_thesis.thesis_figure import ThesisFigure, figure_of_log

Progress = Callable[[str, float], None]

ADDED = "Not in the thesis"
SHORT = {name: name.replace("surface-", "") for name in METHODS}
#: In the picture, where room is scarce.
MARKS = {
    "slip-ratio-ekf": "SR",
    "surface-least-squares": "LS",
    "surface-gaussian-process": "GP",
    "surface-bayesian": "BLR",
    "gradient-descent": "GD",
    "ekf-thesis": "EKF",
    "delayed-state": "DS",
}
SHOWS = (
    "Every surface of chapter 5 and every estimator of chapter 6, beside their baselines. Each window is "
    "predicted from what was known one horizon before it, and the second half of the windows counts; errors "
    "are ratios to those of none, the kinematic baseline without slip. Batch alone has "
    "learned the windows that it is judged on. Surfaces and estimators learn the terms of odd-even-10. "
    "In the picture: SR slip-ratio-ekf, LS least squares, GP Gaussian process, BLR Bayesian surface, GD "
    "gradient descent, EKF ekf-thesis, DS delayed-state."
)


def real_log_figures(fixture: Fixture, progress: Progress) -> list[ThesisFigure]:
    """Make the figures and tables of the real logs."""
    return [
        figure_of_log(
            "real-log-husky",
            ADDED,
            "Surfaces and estimators on a Husky",
            lambda: husky(fixture, lambda what, fraction: progress(what, 0.25 * fraction)),
        ),
        figure_of_log(
            "real-logs-warthog",
            ADDED,
            "Surfaces and estimators on a Warthog",
            lambda: warthog(fixture, lambda what, fraction: progress(what, 0.25 + 0.75 * fraction)),
        ),
    ]


def husky(fixture: Fixture, progress: Progress) -> ThesisFigure:
    """All methods on 200 held commands of a Husky on tiles: the experiment of chapter 4, driven by others."""
    found = log_scores(fixture, [HUSKY], progress)
    means = {log.input: {m: mean_ratios([log], m) for m in METHODS} for log in found}
    return ThesisFigure(
        "real-log-husky",
        ADDED,
        "Surfaces and estimators on a Husky",
        SHOWS,
        _agrees(means),
        _differs(means),
        f"{HUSKY}: a Clearpath Husky on tiles, its tyres deflated, 200 held commands; "
        + "; ".join(
            f"{log.windows} windows of {log.horizon:g} s from the {log.input} input" for log in found
        ),
        (*(_bars(*item) for item in means.items()), *(_one_log(log) for log in found)),
    )


def warthog(fixture: Fixture, progress: Progress) -> ThesisFigure:
    """All methods on all logs of the Warthog."""
    found = log_scores(fixture, warthog_names(fixture), progress)
    inputs = {name: [log for log in found if log.input == name] for name in INPUTS}
    means = {name: {m: mean_ratios(logs, m) for m in METHODS} for name, logs in inputs.items() if logs}
    return ThesisFigure(
        "real-logs-warthog",
        ADDED,
        "Surfaces and estimators on a Warthog",
        SHOWS,
        _agrees(means),
        _differs(means),
        f"{len({log.log for log in found})} logs of a Clearpath Warthog on grass, asphalt, gravel and sand; "
        "horizon 5 s, or 1.9 s where a log has no longer windows. Means are geometric, over the logs with at "
        f"least {FEWEST_WINDOWS} held-out windows.",
        (
            *(_bars(*item) for item in means.items()),
            _mean_table(means),
            *(_all_logs(name, logs) for name, logs in inputs.items() if logs),
        ),
    )


Means = dict[str, dict[str, MeanRatios | None]]


def _bars(input_name: str, ratios: dict[str, MeanRatios | None]) -> Panel:
    shown = [method for method in METHODS if method != "none" and ratios[method] is not None]
    names = tuple(MARKS.get(method, method) for method in shown)
    series = tuple(
        Bars(names, np.array([getattr(ratios[method], error) for method in shown]), label=error)
        for error in ("position", "heading")
    )
    title = f"Mean error as a ratio to none, {input_name} input"
    return Panel(title, "", "ratio [1]", series)


def _one_log(log: LogScores) -> Grid:
    rows = []
    for method, score in log.scores.items():
        rows.append(
            (
                SHORT[method] + ("" if score.causal else " (not causal)"),
                number_text(score.position.mean),
                number_text(score.heading.mean),
                _interval(score.position_ratio),
                _interval(score.heading_ratio),
                number_text(score.nis),
            )
        )
    columns = (
        "method",
        "position [m]",
        "heading [rad]",
        "position / none",
        "heading / none",
        "NIS (3 is true)",
    )
    title = f"{log.input.capitalize()} input, {log.horizon:g} s ahead"
    return Grid(title, columns, tuple(rows), "Means over the held-out windows; 95 % intervals in brackets.")


def _interval(ratio: tuple[float, float, float]) -> str:
    value, low, high = (number_text(number, 2) for number in ratio)
    return f"{value} [{low}, {high}]"


def _mean_table(means: Means) -> Grid:
    columns = (
        "method",
        *(f"{what}, {name}" for name in means for what in ("position", "heading", "worst log")),
    )
    rows = []
    for method in METHODS:
        cells = [SHORT[method]]
        for ratios in means.values():
            found = ratios[method]
            numbers = (found.position, found.heading, found.worst_position) if found else (np.nan,) * 3
            cells += [number_text(number, 2) for number in numbers]
        rows.append(tuple(cells))
    counts = ", ".join(f"{_logs(ratios)} logs with {name} input" for name, ratios in means.items())
    return Grid(
        "Means over the logs, as ratios to none", columns, tuple(rows), f"{counts}; worst log: position."
    )


def _logs(ratios: dict[str, MeanRatios | None]) -> int:
    baseline = ratios["none"]
    return baseline.logs if baseline else 0


def _all_logs(input_name: str, logs: Sequence[LogScores]) -> Grid:
    methods = [m for m in METHODS if m in logs[0].scores]
    columns = ("log", "held out", "horizon [s]", "none [m]", *(SHORT[m] for m in methods if m != "none"))
    rows = [
        (
            log.log,
            str(log.windows),
            f"{log.horizon:g}",
            number_text(log.scores["none"].position.mean, 2),
            *(_cell(log, m) for m in methods if m != "none"),
        )
        for log in logs
    ]
    return Grid(f"{input_name.capitalize()} input, log by log: position error / none", columns, tuple(rows))


def _cell(log: LogScores, method: str) -> str:
    return number_text(log.scores[method].position_ratio[0], 2) if method in log.scores else DASH


def _agrees(means: Means) -> str:
    """What the thesis says of its surfaces and filters, in this run's numbers."""
    said = []
    for input_name, ratios in means.items():
        names = {
            "the surfaces": SURFACES,
            "gradient descent": ON_LINE[:1],
            "the thesis's filter": ON_LINE[1:2],
        }
        parts = [
            f"{what} leave{'s' * (len(methods) == 1)} {', '.join(_position(ratios[m]) for m in methods)}"
            for what, methods in names.items()
        ]
        said.append(f"from the {input_name} input, {', '.join(parts)}")
    return (
        f"Of the kinematic baseline's position error, {'; '.join(said)}. Surfaces: least squares, Gaussian "
        "process, Bayesian. The thesis finds the three similar, and its filter about twice as good as "
        "gradient descent: 0.23 and 0.45 in Table 6.2, in-sample."
    )


def _position(ratios: MeanRatios | None) -> str:
    return number_text(ratios.position, 2) if ratios else DASH


def _differs(means: Means) -> str:
    """Which method is best here, and what the thesis's methods lack."""
    said = []
    for input_name, ratios in means.items():
        known = {m: r for m, r in ratios.items() if r is not None and m not in ("none", "batch")}
        best = min(known, key=lambda m: known[m].position)
        default = "the default" if best == "auto" else f"auto, the default, {_position(known['auto'])}"
        said.append(
            f"From the {input_name} input, {SHORT[best]} leaves least of the position error, "
            f"{_position(known[best])} ({default})."
        )
    said.append(
        "Gradient descent and the thesis's filter have no lag, no delay and no gate for outliers. Surfaces "
        "take lag, delay and clock offset from the filter of edd-2 and see each window as one pair of speed "
        f"and yaw rate; the Gaussian process takes at most {LARGEST_PROCESS} examples. Slip ratios are "
        "defined for wheel speeds alone."
    )
    return " ".join(said)
