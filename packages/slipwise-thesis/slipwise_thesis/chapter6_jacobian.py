# SPDX-License-Identifier: Apache-2.0
"""The thesis's Jacobian (6.7) against the exact one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.logs import Log
from slipwise.number_text import number_text
from slipwise_thesis import _thesis
from slipwise_thesis.chapter6_recording import (
    EXACT,
    HORIZON,
    THESIS,
    Course,
    Recording,
    drive_windows,
    record,
)
from slipwise_thesis.chapter6_table import Errors, mean_and_std
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, Floats, Line, Panel, Points
from slipwise_thesis.thesis_figure import ThesisFigure

LENGTHS = (0.5, 1.0, 2.0, 3.5, 5.0, 7.5, 10.0)  # s


def jacobian_figure(filtered: Recording, log: Log, source: str) -> ThesisFigure:
    """Compare both Jacobians, alone and in the thesis's filter, whose recording with (6.7) is given."""
    courses = {"(6.7)": filtered, "exact": record(log, replace(filtered.course, jacobian=EXACT))}
    wrong = np.array([fractions_wrong(log, length) for length in LENGTHS])
    at = LENGTHS.index(HORIZON)
    series = (
        Line(np.array(LENGTHS), 100.0 * wrong[:, 0], "mean of segments", FITTED),
        Points(np.array(LENGTHS), 100.0 * wrong[:, 0], colour=FITTED),
        Line(np.array(LENGTHS), 100.0 * wrong[:, 1], "worst segment", BASELINE, "dash"),
        Points(np.array(LENGTHS), 100.0 * wrong[:, 1], colour=BASELINE),
    )
    return ThesisFigure(
        key="equation-6-7",
        thesis="Equation 6.7",
        title="The Jacobian of the thesis and the exact one",
        shows="How far the position rows of (6.7) are from the exact derivative, as a part of it (Frobenius "
        "norm, each parameter in units of its prior), over the length of the segment; and the thesis's "
        "filter with either.",
        agrees="Rows of the heading are the same, and over short segments the position rows too: "
        f"{100.0 * wrong[0, 0]:.0f} % off at {LENGTHS[0]:g} s.",
        differs="(6.7) differentiates inside the integral and holds the heading: yaw slip then turns the "
        f"robot but does not move it. Over segments of 5 s its position rows are "
        f"{100.0 * wrong[at, 0]:.0f} % off on average, {100.0 * wrong[at, 1]:.0f} % at worst. The filter "
        "corrects for some of it by feedback: "
        f"{_verdict(log, courses)}",
        source=source,
        parts=(
            Panel("error of (6.7)", "segment [s]", "fraction of the exact rows [%]", series),
            _grid(log, courses),
        ),
    )


def fractions_wrong(log: Log, length: float) -> tuple[float, float]:
    """Mean and largest relative error of the position rows of (6.7) over segments of a length [s]."""
    course = Course("iekf")
    windows = drive_windows(log, course, length)
    motion = _core.MotionModel(_core.named_basis(course.basis), False, False)
    unit = np.array(_core.slip_prior_std(motion.basis, 1.0, 0.5, 1.0))
    fractions = []
    for i, segment in enumerate(windows.segments):
        at = _core.linearize_segment(motion, np.zeros(motion.size), windows.input_history(i), segment)
        exact, thesis = (
            np.array(_thesis.segment_jacobian(kind, motion, at, segment))[:2] * unit
            for kind in (EXACT, THESIS)
        )
        fractions.append(float(np.linalg.norm(thesis - exact) / np.linalg.norm(exact)))
    return float(np.mean(fractions)), float(np.max(fractions))


def _grid(log: Log, courses: dict[str, Recording]) -> Grid:
    rows = []
    for name, recording in courses.items():
        errors = _errors(log, recording)
        cells = [
            f"{number_text(mean[k])} ± {number_text(std[k])}"
            for mean, std in (mean_and_std(errors.in_sample), mean_and_std(errors.honest))
            for k in (0, 1)
        ]
        rows.append((name, *cells))
    heads = ("Jacobian", "in-sample position [m]", "heading [rad]", "honest position [m]", "heading [rad]")
    return Grid("The thesis's filter, terms of (6.10), from wheel speeds", heads, tuple(rows))


def _errors(log: Log, recording: Recording) -> Errors:
    targets = drive_windows(log, recording.course, HORIZON)
    return Errors.of(recording.predictions(targets, recording.course.estimator))


def _verdict(log: Log, courses: dict[str, Recording]) -> str:
    means: dict[str, Floats] = {
        name: _errors(log, recording).honest.mean(axis=0) for name, recording in courses.items()
    }
    ratio = means["exact"] / means["(6.7)"]
    return (
        f"with the exact Jacobian its honest errors are {number_text(ratio[0])} (position) and "
        f"{number_text(ratio[1])} (heading) times those with (6.7)."
    )
