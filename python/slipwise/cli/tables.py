# SPDX-License-Identifier: Apache-2.0
"""The tables that commands show to people."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.cli.output import Column, Output
from slipwise.models.limits import limit_rows
from slipwise.number_text import number_text

if TYPE_CHECKING:
    from slipwise.calibration import History, Verdict
    from slipwise.calibration.identifiability import LookAlike
    from slipwise.evaluation import Evaluation, Score
    from slipwise.evaluation.result import ErrorSummary
    from slipwise.logs import LeftOut
    from slipwise.models.schema import LimitsSection, Parameter

_MOST_ALARMS = 6
_MOST_PAIRS = 6


def show_notes(output: Output, notes: Sequence[str]) -> None:
    """Say what was guessed."""
    for note in notes:
        output.line(f"  {note}")


def show_left_out(output: Output, left_out: Sequence[LeftOut]) -> None:
    """Show what was left out, how often and where first."""
    if not left_out:
        output.line("Nothing was left out.")
        return
    rows = [(str(entry.count), entry.reason, entry.where) for entry in left_out]
    output.table("Left out", (Column("count", True), Column("what"), Column("first at")), rows)


def show_alarms(output: Output, history: History) -> None:
    """Say when the ground seemed to change; nothing where it did not."""
    alarms = history.alarms()
    if not alarms:
        return
    shown = ", ".join(f"{t:.1f} s of run {run}" for run, t in alarms[:_MOST_ALARMS])
    more = f" and {len(alarms) - _MOST_ALARMS} more" if len(alarms) > _MOST_ALARMS else ""
    times = "once" if len(alarms) == 1 else f"{len(alarms)} times"
    output.line(f"The ground seems to change {times}: at {shown}{more}. What was learned before counts less.")


def show_verdict(output: Output, verdict: Verdict) -> None:
    """Show the verdict and the drives that would determine what is not."""
    output.line(("" if verdict.good else "NOT GOOD ENOUGH. ") + verdict.sentence)
    for advice in verdict.advice:
        output.line(f"  {advice}")
    if verdict.timing:
        output.line(verdict.timing)


def show_files(output: Output, files: Mapping[str, Path]) -> None:
    """Show what was written where."""
    width = max(map(len, files), default=0)
    for name, path in files.items():
        output.line(f"{name:<{width}}  {path}")


def show_parameters(output: Output, parameters: Sequence[Parameter]) -> None:
    """Show every parameter, lag and delay in seconds."""
    rows = []
    for p in parameters:
        name, value, std, unit = in_plain_units(p)
        left = number_text(p.std / p.prior_std, 2) if p.prior_std > 0.0 else ""
        rows.append(
            (name, number_text(value), number_text(std, 2), unit, left, "yes" if p.determined else "no")
        )
    columns = (
        Column("parameter"),
        Column("value", True),
        Column("std", True),
        Column("unit"),
        Column("std / before", True),
        Column("determined"),
    )
    output.table("Parameters", columns, rows)


def show_look_alikes(output: Output, pairs: Sequence[LookAlike]) -> None:
    """Say which parameters the log can hardly tell apart; nothing where there are none."""
    if pairs:
        shown = ", ".join(map(str, pairs[:_MOST_PAIRS]))
        more = f" and {len(pairs) - _MOST_PAIRS} more pairs" if len(pairs) > _MOST_PAIRS else ""
        output.line(f"Hard to tell apart (correlation of their errors): {shown}{more}.")


def show_limits(output: Output, limits: LimitsSection | None) -> None:
    """Show the limits of the drive that wheel speeds showed; nothing where there are none."""
    if limits is None:
        return
    rows = [
        (name, number_text(value), number_text(std, 2), unit) for name, value, std, unit in limit_rows(limits)
    ]
    columns = (Column("limit"), Column("value", True), Column("std", True), Column("unit"))
    output.table("Limits of the drive", columns, rows)


def in_plain_units(parameter: Parameter) -> tuple[str, float, float, str]:
    """Return name, value, standard deviation and unit; what is learned as a logarithm in its own unit."""
    name, unit = parameter.name.removeprefix("log_"), parameter.unit.removeprefix("ln ")
    if name == parameter.name:
        return name, parameter.value, parameter.std, unit
    value = math.exp(parameter.value)
    return name, value, value * parameter.std, unit


def show_scores(output: Output, evaluation: Evaluation) -> None:
    """Show one table per horizon: errors, ratios, the in-sample residual and how honest the covariance is."""
    for horizon in evaluation.horizons:
        scores = [score for score in evaluation.scores if score.horizon == horizon]
        title = f"After {horizon:g} s, from {evaluation.input}s ({scores[0].windows} held-out windows)"
        output.table(title, _SCORE_COLUMNS, [_score_row(score) for score in scores])
    output.line(_LEGEND)
    if any(not score.causal for score in evaluation.scores):
        output.line("† not causal: it has learned from the very windows it is judged on.")


_SCORE_COLUMNS = (
    Column("method", whole=True),
    Column("position [m]", True),
    Column("/none", True),
    Column("/rival", True),
    Column("in-sample*", True),
    Column("heading [deg]", True),
    Column("/none", True),
    Column("/rival", True),
    Column("in-sample*", True),
    Column("NIS", True),
    Column("50/90/95 %", True),
)
_LEGEND = (
    "Mean errors with 95 % intervals; /none and /rival: relative to doing nothing and to the best other one. "
    "NIS is 3 and the shares are 50/90/95 % where the predicted covariance is true. "
    "* too optimistic: the error after the window itself was learned, as in the thesis."
)


def _score_row(score: Score) -> tuple[str, ...]:
    degrees = math.degrees(1.0)
    return (
        score.method + ("" if score.causal else " †"),
        _error(score.position, 1.0),
        number_text(score.position_ratio[0], 2),
        number_text(score.position_to_rival, 2),
        number_text(score.in_sample_position, 2),
        _error(score.heading, degrees),
        number_text(score.heading_ratio[0], 2),
        number_text(score.heading_to_rival, 2),
        number_text(score.in_sample_heading * degrees, 2),
        number_text(score.nis, 2),
        "/".join(f"{100.0 * share:.0f}" for share in score.coverage),
    )


def _error(summary: ErrorSummary, scale: float) -> str:
    low, high = number_text(summary.low * scale, 2), number_text(summary.high * scale, 2)
    return f"{number_text(summary.mean * scale)} ({low}–{high})"
