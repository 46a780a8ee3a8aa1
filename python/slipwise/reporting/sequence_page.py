# SPDX-License-Identifier: Apache-2.0
"""The page of a sequence of logs: surfaces along time, visits, and what is remembered."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration.learned_sequence import SurfaceChange, VisitedLog
from slipwise.evaluation.sequence import REMEMBERING, SequenceEvaluation
from slipwise.files import write_text_whole
from slipwise.logs.log import Log
from slipwise.reporting.ground_strip import GroundMark, GroundStrip, strip_html
from slipwise.reporting.markup import missing, number, paragraph, table
from slipwise.reporting.named_surfaces import named_surfaces
from slipwise.reporting.page import Part, page_of
from slipwise.reporting.sections.ground import bank_table
from slipwise.reporting.sections.scores import HAS_SEEN
from slipwise.reporting.timeline import Timeline

Floats = NDArray[np.float64]


def write_sequence_page(
    path: Path, logs: Sequence[Log], sequence: SequenceEvaluation, *, title: str, command: str = ""
) -> Path:
    """Write one self-contained HTML page that works offline.

    Args:
        path: the file to write.
        logs: those of the sequence, in its order.
        sequence: what `evaluate_sequence` made of them.
        title: heading of the page, any text.
        command: the command line, shown as provenance.

    Returns:
        The path that was written.

    Raises:
        OutputError: the file cannot be written.
    """
    write_text_whole(path, sequence_page(logs, sequence, title=title, command=command))
    return path


def sequence_page(logs: Sequence[Log], sequence: SequenceEvaluation, *, title: str, command: str = "") -> str:
    """Return the page; see `write_sequence_page`."""
    made = f"Made by {command}" if command else "Made by slipwise.evaluation.evaluate_sequence."
    parts = (
        Part(
            "Which ground the robot was on",
            "As high as each surface was probable once a window was learned; triangles are what was decided.",
            _strip(logs, sequence),
        ),
        Part(
            "The surfaces that are remembered",
            "What another drive would begin with.",
            bank_table(sequence.learned.surfaces),
        ),
        Part(
            "Each visit",
            f"Mean errors of `{REMEMBERING}` at the longest horizon, held out, beside one learner that goes "
            "on without a memory, and no slip at all.",
            _visits(sequence),
        ),
        Part("How to make this again", "The command line.", paragraph(made)),
    )
    return page_of(title, "slipwise drives in turn", parts)


def _strip(logs: Sequence[Log], sequence: SequenceEvaluation) -> str:
    """All logs on one axis of time, one after the other."""
    timelines = [Timeline.of(log) for log in logs]
    begins = _begins(logs)
    x, alarms, marks = [], [], []
    dated: list[tuple[int, SurfaceChange]] = []
    names = tuple(
        dict.fromkeys(n for log in sequence.learned.logs for n in (log.course.names if log.course else ()))
    )
    rows: list[Floats] = []
    windows = 0
    for visited, timeline, begin in zip(sequence.learned.logs, timelines, begins, strict=True):
        course = visited.course
        if course is None:
            continue
        at = begin + timeline.at(course.run, course.t)
        row = np.zeros((len(at), len(names)))
        row[:, [names.index(name) for name in course.names]] = course.probability
        for change in visited.changes:
            dated.append((windows + _before(visited, change), change))
            marks.append(GroundMark(_when(change, timeline, begin), _words(change)))
        x.append(at)
        rows.append(row)
        alarms += at[np.flatnonzero(course.alarm)].tolist()
        windows += len(at)
    if not windows:
        return missing("No window was learned, so nothing is known of the ground.")
    last = sequence.learned.logs[-1].surface
    shown, probability = named_surfaces(names, np.concatenate(rows), dated, last=last)
    strip = GroundStrip(
        np.concatenate(x), shown, probability, tuple(alarms), tuple(marks), tuple(begins[1:].tolist())
    )
    return strip_html(strip, title="time, drives one after another [s]")


def _begins(logs: Sequence[Log]) -> Floats:
    """Where each log begins on the axis [s]."""
    lengths = [sum(run.span[1] - run.span[0] for run in log.runs) for log in logs]
    return np.concatenate([[0.0], np.cumsum(lengths)[:-1]])


def _before(visited: VisitedLog, change: SurfaceChange) -> int:
    """How many windows of the log were learned when it was decided."""
    course = visited.course
    if course is None or not np.isfinite(change.t) or _at_start(change):
        return 0
    earlier = (course.run < change.run) | ((course.run == change.run) & (course.t <= change.t + 1e-9))
    return int(earlier.sum())


def _at_start(change: SurfaceChange) -> bool:
    """What is kept of the drive before is said when the next one begins."""
    return change.what == "merged" or (change.what == "new" and bool(change.name))


def _when(change: SurfaceChange, timeline: Timeline, begin: float) -> float:
    if not np.isfinite(change.t) or _at_start(change):
        return begin
    return begin + timeline.seconds(change.run, change.t)


def _words(change: SurfaceChange) -> str:
    name = change.name or "a new surface"
    text = {
        "new": f"{name} is remembered" if change.name else "another surface, not driven before",
        "recalled": f"{name} recalled",
        "kept": f"still {name}",
        "merged": f"{change.other} cannot be distinguished from {name}: merged",
        "dropped": f"{name} forgotten: too many",
    }[change.what]
    return f"{text}, probability {change.probability:.3f}" if change.what in ("recalled", "kept") else text


def _visits(sequence: SequenceEvaluation) -> str:
    head = (
        "log",
        "surface",
        "windows",
        "position [m]",
        "heading [rad]",
        "first ten [m]",
        "[rad]",
        "going on [m]",
        "[rad]",
        "no slip [m]",
        "[rad]",
    )
    rows = [
        (
            visit.log if causal else f"{visit.log} ({HAS_SEEN})",
            visit.surface or "open",
            str(visit.windows),
            *(
                number(value)
                for value in (
                    visit.position,
                    visit.heading,
                    visit.first_position,
                    visit.first_heading,
                    visit.going_on_position,
                    visit.going_on_heading,
                    visit.baseline_position,
                    visit.baseline_heading,
                )
            ),
        )
        for visit, causal in zip(sequence.visits(), sequence.causal, strict=True)
    ]
    return table(head, rows)
