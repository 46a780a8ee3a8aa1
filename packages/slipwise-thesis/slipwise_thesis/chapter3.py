# SPDX-License-Identifier: Apache-2.0
"""Chapter 3: how the perturbed equations of motion are integrated and linearised."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipwise import _core
from slipwise.number_text import number_text
from slipwise_thesis import _thesis
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.panel import BASELINE, FITTED, GREY, Floats, Line, Panel, Points
from slipwise_thesis.thesis_figure import ThesisFigure

TIME = 5.0  # [s] of the segments of chapter 6
TWIST = (2.0, 1.0)  # [m/s], [rad/s]: the fastest and tightest of the simulated circles
STEPS = np.array([2.5, 1.25, 1.0, 0.5, 0.25, 0.125, 0.1, 0.05])  # [s]
CONSTANT_TWIST = 2880.0  # Simpson's rule: relative error f^4 / 2880 of a step that turns by f
FRACTIONS = np.linspace(0.0, 0.6, 25)  # of the commanded turn that is lost


def chapter3_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the figures and tables of the vehicle model."""
    del fixture  # nothing is simulated
    progress("integration", 0.0)
    return [integration(), linearisation()]


def _segment() -> _core.Segment:
    return _core.Segment(0.0, TIME, _core.Pose2(0.0, 0.0, 0.0), None, 0.0, 0.0)


def _inputs(step: float) -> _core.InputHistory:
    """Return the held twist as commands that come every `step` seconds."""
    t = np.arange(0.0, TIME, step)
    return _core.InputHistory(t, np.full(len(t), TWIST[0]), np.zeros(len(t)), np.full(len(t), TWIST[1]))


def _miss(step: float, integrator: _core.Integrator) -> float:
    """Distance [m] of the last position from that of the closed form."""
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    path = _core.integrate_segment(model, np.zeros(2), _inputs(step), _segment(), integrator)
    true = np.array(_thesis.steady_path(_core.BodyTwist(TWIST[0], 0.0, TWIST[1]), np.array([TIME])))
    return float(np.hypot(*(path.poses[-1] - true[-1])[:2]))


def integration() -> ThesisFigure:
    """Compare the thesis's Runge-Kutta integration (3.9) with the exact step."""
    runge_kutta = np.array([_miss(step, _core.Integrator.Rk4) for step in STEPS])
    exact = np.array([_miss(step, _core.Integrator.Exact) for step in STEPS])
    circle = 2 * TWIST[0] / TWIST[1] * abs(np.sin(TWIST[1] * TIME / 2))
    theory = circle * (TWIST[1] * STEPS) ** 4 / CONSTANT_TWIST
    order = float(np.polyfit(np.log(STEPS[2:]), np.log(runge_kutta[2:]), 1)[0])
    panel = Panel(
        f"A held {TWIST[0]:g} m/s and {TWIST[1]:g} rad/s for {TIME:g} s",
        "step [s]",
        "error of the last position [m]",
        (
            Line(STEPS, theory, "f⁴ / 2880 of the chord", GREY, "dash"),
            Points(STEPS, runge_kutta, None, "Runge-Kutta of fourth order", BASELINE, "square", 7.0),
            Points(STEPS, np.maximum(exact, 1e-17), None, "exact step", FITTED, "dot", 7.0),
        ),
        log_x=True,
        log_y=True,
    )
    at_tenth = float(runge_kutta[np.argmin(np.abs(STEPS - 0.1))])
    return ThesisFigure(
        key="equation-3-9",
        thesis="Equation 3.9",
        title="Integration of the perturbed motion",
        shows="Error of the last position over the step, where the twist is constant.",
        agrees=f"Fourth-order Runge-Kutta, which the thesis uses, converges with order {order:.1f}; with "
        f"steps of 0.1 s its error of {number_text(at_tenth)} m does not matter beside slip.",
        differs=f"The exact step of SE(2) has no error but rounding, {number_text(float(exact.max()), 2)} m "
        "at the most, at any step; it is the default. The thesis gives no errors of its "
        "integration.",
        source="a held twist, no simulation",
        parts=(panel,),
    )


def linearisation() -> ThesisFigure:
    """Compare linearised (3.8) with nonlinear (3.9) perturbation dynamics."""
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    plain = _core.linearize_segment(model, np.zeros(2), _inputs(TIME), _segment())
    slope = np.array(plain.by_parameter)[:, 1]  # by the part of the turn that slip adds
    ends: list[Floats] = []
    for fraction in FRACTIONS:
        path = _core.integrate_segment(
            model, np.array([0.0, -fraction]), _inputs(TIME), _segment(), _core.Integrator.Exact
        )
        ends.append(np.array(path.poses[-1]))
    moved = np.array(ends) - ends[0]
    linear = -FRACTIONS[:, None] * slope
    size = np.hypot(moved[:, 0], moved[:, 1])
    off = np.hypot(*(moved - linear)[:, :2].T)
    panel = Panel(
        f"{TWIST[0]:g} m/s and {TWIST[1]:g} rad/s for {TIME:g} s",
        "lost part of the commanded turn [1]",
        "position [m]",
        (
            Line(FRACTIONS, size, "how far slip moves the end", FITTED),
            Line(FRACTIONS, off, "error of the linearised displacement", BASELINE, "dash"),
        ),
    )
    small, half = (int(np.argmin(np.abs(FRACTIONS - fraction))) for fraction in (0.05, 0.5))
    return ThesisFigure(
        key="equation-3-8",
        thesis="Equations 3.4 to 3.11",
        title="Linearised against nonlinear perturbation dynamics",
        shows="How far a constant angular slip moves the end of a segment, and how wrong the linearised "
        "displacement is.",
        agrees=f"With small slip the linear one does: where {100 * FRACTIONS[small]:.0f} % of the turn are "
        f"lost it misses by {100 * off[small] / size[small]:.0f} % of the displacement. The thesis calls "
        "the nonlinear form easier for prediction.",
        differs=f"At a skid-steered robot's slip, {100 * FRACTIONS[half]:.0f} % of the turn, it misses by "
        f"{100 * off[half] / size[half]:.0f} %, {number_text(float(off[half]))} m. So slipwise predicts "
        "with the nonlinear form, and linearises around the current slip, for covariances and for "
        "learning. (3.8) is used with Φ(n, k+1) in place of Φ(n, k), with k = 0 to n - 1.",
        source="a held twist, no simulation",
        parts=(panel,),
    )
