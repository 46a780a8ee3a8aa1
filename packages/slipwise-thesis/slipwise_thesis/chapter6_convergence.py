# SPDX-License-Identifier: Apache-2.0
"""Figures 6.3 to 6.5: residuals with and without slip, and how the parameters settle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.predictions import residual
from slipwise.number_text import number_text
from slipwise_thesis.chapter6_recording import Recording
from slipwise_thesis.panel import BASELINE, FITTED, Floats, Line, Panel
from slipwise_thesis.thesis_figure import ThesisFigure

WORST = 100  # one of so many segments counts as worst
EVERY = 10  # one of so many updates is drawn: two a second
CHANNELS = (("x", "forward"), ("y", "sideways"), ("ω", "angular"))  # names of (6.10), of slipwise
TERMS = ("κ", "V", "κV", "κ²", "V²")


def residual_figure(descent: Recording, source: str) -> ThesisFigure:
    """Make figure 6.3."""
    baseline, learned = without_slip(descent), descent.innovation
    ratio = _size(baseline) / _size(learned)
    worst = np.argsort(np.hypot(*learned[:, :2].T))[-(len(learned) // WORST) :]
    early = 100.0 * float(np.mean(descent.fed.end[worst] < descent.t[0] + 60.0))
    changed = _changed(descent)
    t = descent.t[1:]
    return ThesisFigure(
        key="figure-6-3",
        thesis="Figure 6.3",
        title="Relative pose residuals with gradient descent, and without slip",
        shows="Residual of every overlapping path segment of 5 s at the moment of its update, from nothing "
        "on; below it without predicted slip.",
        agrees=f"Residuals are minimal with a few exceptions: {_size_text(learned)} on average where no slip "
        f"leaves {_size_text(baseline)} ({number_text(ratio[0], 2)} and {number_text(ratio[1], 2)} times as "
        f"much). Of the worst hundredth of segments, {early:.0f} % lie in the first minute.",
        differs="These are in-sample residuals: the parameters have seen all but the last 0.05 s of the "
        "segment. Table 6.2 has honest predictions beside them. The thesis's largest errors come with drops "
        "of the commanded speed, which reaches the wheels late. The inputs here are wheel speeds, and yet "
        f"{100.0 * np.mean(changed[worst]):.0f} % of the worst hundredth lie across a change of command (of "
        f"all segments {100.0 * np.mean(changed):.0f} %): parameters that follow a circle miss on the next.",
        source=source,
        parts=(
            *_residual_panels(t, learned, "gradient descent"),
            *_residual_panels(t, baseline, "without slip"),
        ),
    )


def descent_figure(descent: Recording, source: str) -> ThesisFigure:
    """Make figure 6.4."""
    return ThesisFigure(
        key="figure-6-4",
        thesis="Figure 6.4",
        title="Parameter convergence during gradient descent",
        shows="The 15 parameters of (6.10), all zero at first, over time.",
        agrees="All parameters start at zero and move at once to values that explain the segments: "
        "figure 6.3 shows how soon.",
        differs=f"They do not settle. {_settling(descent)} Gradient descent has no memory of how sure "
        "it is, and follows the manoeuvre that is driven. A damped pseudo-inverse takes the place of the "
        "inverse of a 3x15 Jacobian in (6.6), which does not exist.",
        source=source,
        parts=parameter_panels(descent),
    )


def filter_figure(filtered: Recording, descent: Recording, source: str) -> ThesisFigure:
    """Make figure 6.5."""
    ratio = _size(descent.innovation) / _size(filtered.innovation)
    prior = filtered.prior_std[-1]
    apart = float(
        np.linalg.norm((filtered.mean[-1] - descent.mean[-1]) / prior)
        / np.linalg.norm(filtered.mean[-1] / prior)
    )
    more = "less" if ratio[0] > 1.0 else "more"
    return ThesisFigure(
        key="figure-6-5",
        thesis="Figure 6.5",
        title="Extended Kalman filter: parameters and residuals",
        shows="The same drive learned by the filter of Table 6.1 as written, with its Jacobian (6.7).",
        agrees="The parameters converge to other values than those of gradient descent: their difference is "
        f"{100.0 * apart:.0f} % as long as the filter's own, in units of the priors. {_settling(filtered)}",
        differs=f"Its residuals are {_size_text(filtered.innovation)}, {more} than those of gradient descent "
        f"({_size_text(descent.innovation)}): Table 6.2 shows which predicts better. The thesis takes "
        "the different values for local minima; the terms of (6.10) do not hold this terrain's slip, so each "
        "estimator settles on what fits the segments as it weighs them.",
        source=source,
        parts=(*parameter_panels(filtered), *_residual_panels(filtered.t[1:], filtered.innovation, "filter")),
    )


def parameter_panels(recording: Recording) -> tuple[Panel, ...]:
    """Draw the parameters of thesis-15 over time, a panel per channel."""
    t, mean = recording.t[::EVERY], recording.mean[::EVERY]
    return tuple(
        Panel(
            f"{name} slip rate",
            "time [s]",
            "parameter [SI units]",
            tuple(
                Line(t, mean[:, 5 * channel + place], f"α{place + 1},{symbol}: {term}")
                for place, term in enumerate(TERMS)
            ),
        )
        for channel, (symbol, name) in enumerate(CHANNELS)
    )


def without_slip(recording: Recording) -> Floats:
    """Residuals [K, 3] of the same segments, predicted without slip."""
    baseline = _core.MotionModel(_core.Basis("none", [], [], []), False, False)
    fed = recording.fed
    predicted = np.array(
        [
            _core.integrate_segment(
                baseline, np.zeros(0), fed.input_history(i), fed.segments[i], _core.Integrator.Exact
            ).poses[-1]
            for i in range(len(fed))
        ]
    )
    return residual(fed.measured, predicted)


def _size(innovation: Floats) -> Floats:
    """Mean position [m] and heading [rad] error."""
    return np.array([np.hypot(*innovation[:, :2].T).mean(), np.abs(innovation[:, 2]).mean()])


def _size_text(innovation: Floats) -> str:
    position, heading = _size(innovation)
    return f"{number_text(position)} m and {number_text(heading)} rad"


def _residual_panels(t: Floats, left: Floats, name: str) -> tuple[Panel, Panel]:
    t, left = t[::EVERY], left[::EVERY]
    position = Line(t, np.hypot(left[:, 0], left[:, 1]), colour=FITTED, width=1.0)
    heading = Line(t, np.abs(left[:, 2]), colour=BASELINE, width=1.0)
    return (
        Panel(f"position, {name}", "time [s]", "residual [m]", (position,)),
        Panel(f"heading, {name}", "time [s]", "residual [rad]", (heading,)),
    )


def _settling(recording: Recording) -> str:
    """How much of the way to the end is done after two minutes."""
    at = int(np.searchsorted(recording.t, recording.t[0] + 120.0))
    at = min(at, len(recording.t) - 1)
    prior = recording.prior_std[-1]
    whole = float(np.linalg.norm(recording.mean[-1] / prior))
    left = float(np.linalg.norm((recording.mean[-1] - recording.mean[at]) / prior))
    return (
        f"After {recording.t[at] - recording.t[0]:.0f} s their distance to their end is still "
        f"{100.0 * left / whole:.0f} % of what it was at the start."
    )


def _changed(recording: Recording) -> NDArray[np.bool_]:
    """Whether the command changed within each segment, [K]."""
    commands = recording.fed.drive[0].run.commands
    if commands is None:
        return np.zeros(len(recording.fed), dtype=np.bool_)
    steps = (np.diff(commands.v, prepend=commands.v[0]) != 0.0) | (
        np.diff(commands.omega, prepend=commands.omega[0]) != 0.0
    )
    changes = np.cumsum(steps)
    first, last = (
        np.searchsorted(commands.t, at, side="right").clip(1) - 1
        for at in (recording.fed.start, recording.fed.end)
    )
    return np.asarray(changes[last] > changes[first])
