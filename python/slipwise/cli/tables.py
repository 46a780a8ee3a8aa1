# SPDX-License-Identifier: Apache-2.0
"""The tables that commands show to people."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from slipwise.cli.output import Column, Output
from slipwise.cli.run_folder import killed_runs
from slipwise.models.parameter_table import IDENTIFIED_FRACTION, NEGLIGIBLE
from slipwise.models.share_words import SHARE_HEAD, share_rows
from slipwise.models.summary import verdict_label
from slipwise.number_text import count_text, estimate_texts, number_text

if TYPE_CHECKING:
    from slipwise.calibration import History, Verdict
    from slipwise.calibration.identifiability import Confounded
    from slipwise.calibration.learned_sequence import LearnedSequence, SurfaceSummary
    from slipwise.evaluation import Evaluation, Score
    from slipwise.evaluation.result import ErrorSummary
    from slipwise.logs import LeftOut
    from slipwise.models.model import Model
    from slipwise.models.parameter_table import PhysicalParameter
    from slipwise.models.schema import SurfaceSection, VerdictSection
    from slipwise.models.summary import Summary

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
    """Say when the terrain seemed to change, if it did."""
    alarms = history.alarms()
    if not alarms:
        return
    shown = ", ".join(f"{t:.1f} s of run {run}" for run, t in alarms[:_MOST_ALARMS])
    more = f" and {len(alarms) - _MOST_ALARMS} more" if len(alarms) > _MOST_ALARMS else ""
    changes = count_text(len(alarms), "change")
    output.line(f"{changes} of terrain found: {shown}{more}. What was learned before counts less.")


def show_summary(output: Output, summary: Summary) -> None:
    """Say what was learned, one sentence a line."""
    for sentence in summary.sentences:
        output.line(f"  {sentence}")


def show_verdict(output: Output, verdict: Verdict | VerdictSection, next_step: Sequence[str] = ()) -> None:
    """Show the verdict, the next step, and the drives that would determine what is not."""
    label, colour = verdict_label(verdict)
    output.line(verdict.sentence, label=label, colour=colour)
    for step in next_step:
        output.line(step)
    for advice in verdict.advice:
        output.line(f"  {advice}")
    if verdict.timing:
        output.line(f"  {verdict.timing}")
    if verdict.force:
        output.line(f"  {verdict.force}")


def show_files(output: Output, files: Mapping[str, Path]) -> None:
    """Show what was written where."""
    width = max(map(len, files), default=0)
    for name, path in files.items():
        output.line(f"{name:<{width}}  {path}")


def show_parameters(output: Output, parameters: Sequence[PhysicalParameter]) -> None:
    """Show every parameter in its physical unit, and whether it is identified."""
    rows = [
        (p.name, *estimate_texts(p.value, p.std), p.unit, "yes" if p.identified else "no") for p in parameters
    ]
    columns = (
        Column("parameter", whole=True),
        Column("value", True, whole=True),
        Column("std", True, whole=True),
        Column("unit"),
        Column("identified"),
    )
    caption = (
        f"Identified: std is at most {IDENTIFIED_FRACTION:.0%} of the value; or, where 0 means no effect, at "
        f"most {NEGLIGIBLE:.0%} of the motion in the log, {NEGLIGIBLE:g} s, m or rad."
    )
    output.table("Parameters", columns, rows, caption=caption)


def show_shares(output: Output, model: Model) -> None:
    """Show what arrives of commands, at the wheels and at the body; nothing where the log does not say it."""
    rows = share_rows(model)
    if rows:
        heads = [Column(name, place > 0, whole=True) for place, name in enumerate(SHARE_HEAD)]
        output.table("What arrives of commands over the log", heads, rows)


def show_confounded(output: Output, pairs: Sequence[Confounded]) -> None:
    """Say which parameters the log can hardly separate, if there are any."""
    if pairs:
        shown = ", ".join(map(str, pairs[:_MOST_PAIRS]))
        more = f" and {len(pairs) - _MOST_PAIRS} more pairs" if len(pairs) > _MOST_PAIRS else ""
        output.line(f"Hard to separate (correlation of their errors): {shown}{more}.")


def show_killed_runs(output: Output, runs: Path) -> None:
    """Name the run folders that a killed process left incomplete."""
    killed = killed_runs(runs)
    if killed:
        names = ", ".join(map(str, killed))
        output.line(f"Incomplete, since the process was killed, and yours to remove: {names}.")


def show_surfaces(output: Output, surfaces: Sequence[SurfaceSummary | SurfaceSection]) -> None:
    """Show the surfaces that are remembered."""
    columns = ("driven [s]", "segments", "visits", "speed [m/s]", "yaw rate [rad/s]", "last seen")
    rows = [
        (
            surface.name,
            f"{surface.seconds:.0f}",
            f"{surface.segments}",
            f"{surface.visits}",
            f"{surface.speed:.2f}",
            f"{surface.yaw_rate:.2f}",
            surface.last_seen,
        )
        for surface in surfaces
    ]
    output.table("Surfaces", (Column("name"), *(Column(name, True) for name in columns)), rows)


def show_memory_changes(output: Output, names: Sequence[str], learned: LearnedSequence) -> None:
    """Say which surfaces became one or were dropped, and what labels were worth."""
    for name, log in zip(names, learned.logs, strict=True):
        for change in log.changes:
            if change.what == "merged":
                output.line(
                    f"{name}: {change.other} cannot be distinguished from {change.name}, and is one with it."
                )
            elif change.what == "dropped":
                output.line(f"{name}: {change.name} was dropped, as the least used of too many.")
    judged, right = learned.labels
    if judged:
        output.line(f"Labels were right {right:.0f} times of {judged:.0f}.")


NOT_CAUSAL = "† not causal: it has learned from the very segments it is judged on."


def marked(name: str, *, causal: bool) -> str:
    """Return a name, with the mark that `NOT_CAUSAL` explains."""
    return name if causal else f"{name} †"


def show_scores(output: Output, evaluation: Evaluation) -> None:
    """Show one table per horizon: errors, ratios, the in-sample residual and how honest the covariance is."""
    from slipwise.evaluation.result import embargo_sentence

    for horizon in evaluation.horizons:
        scores = [score for score in evaluation.scores if score.horizon == horizon]
        title = f"After {horizon:g} s, from {evaluation.input}s ({scores[0].windows} held-out segments)"
        output.table(title, _SCORE_COLUMNS, [_score_row(score) for score in scores])
    output.line(f"{_LEGEND} {embargo_sentence(evaluation.embargo)}")
    if any(not score.causal for score in evaluation.scores):
        output.line(NOT_CAUSAL)


_SCORE_COLUMNS = (
    Column("method"),
    Column("position [m]", True),
    Column("/none", True),
    Column("/rival", True, spare=3),
    Column("in-sample*", True, spare=4),
    Column("heading [deg]", True),
    Column("/none", True),
    Column("/rival", True, spare=3),
    Column("in-sample*", True, spare=4),
    Column("NIS", True, spare=1),
    Column("50/90/95 %", True, spare=2),
)
_LEGEND = (
    "Mean errors with 95 % intervals; /none and /rival: relative to doing nothing and to the best other one. "
    "NIS is 3 and the fractions are 50/90/95 % where the predicted covariance is true. "
    "* too optimistic: the error after the segment itself was learned, as in the thesis."
)


def _score_row(score: Score) -> tuple[str, ...]:
    degrees = math.degrees(1.0)
    return (
        marked(score.method, causal=score.causal),
        _error(score.position, 1.0),
        number_text(score.position_ratio[0], 2),
        number_text(score.position_to_rival, 2),
        number_text(score.in_sample_position, 2),
        _error(score.heading, degrees),
        number_text(score.heading_ratio[0], 2),
        number_text(score.heading_to_rival, 2),
        number_text(score.in_sample_heading * degrees, 2),
        number_text(score.nis, 2),
        "/".join(f"{100.0 * fraction:.0f}" for fraction in score.coverage),
    )


def _error(summary: ErrorSummary, scale: float) -> str:
    if summary.mean == summary.high == 0.0:  # nothing was measured
        return "–"
    low, high = number_text(summary.low * scale, 2), number_text(summary.high * scale, 2)
    return f"{number_text(summary.mean * scale)} ({low}–{high})"
