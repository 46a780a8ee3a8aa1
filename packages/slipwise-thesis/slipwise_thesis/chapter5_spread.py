# SPDX-License-Identifier: Apache-2.0
"""The surface of standard deviations (5.6) to (5.8), beside the one by the logarithm of squared residuals."""

from __future__ import annotations

import numpy as np

from slipwise.number_text import number_text
from slipwise_thesis.chapter5_examples import CHANNELS, UNITS, all_examples
from slipwise_thesis.chapter5_surfaces import TERMS
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.panel import BASELINE, FITTED, MEASURED, Line, Panel, Points
from slipwise_thesis.surfaces import LeastSquaresSurface, SlipExamples
from slipwise_thesis.thesis_figure import ThesisFigure

CURVATURE = 0.25  # [1/m] at which both are drawn


def spread_figure(fixture: Fixture) -> ThesisFigure:
    """Compare both forms of the standard deviation."""
    sources = all_examples(fixture)
    examples = sources[0].whole
    forms = _forms(examples)
    at = {name: form.predict(examples.v, examples.omega).std.mean(axis=0) for name, form in forms.items()}
    wide = ", ".join(number_text(fraction, 2) for fraction in at["thesis (5.6)"] / at["log-variance"])
    negative = ", ".join(
        f"{100.0 * _negative(source.whole):.0f} % ({source.source.split(',')[0]})" for source in sources
    )
    return ThesisFigure(
        key="equation-5-6",
        thesis="Equations 5.6 to 5.8",
        title="Two surfaces of standard deviations",
        shows="The standard deviation of a segment's slip rate over speed at one curvature, and the rms "
        "residuals there to either side.",
        agrees="Both forms see how large the residuals are where segments are.",
        differs="The thesis regresses absolute residuals, whose mean is 0.8 of the standard deviation, on "
        f"terms without a constant: beside the other form (5.6) reads {wide} on average (forward, sideways, "
        "angular; tyre-force terrain), goes to zero with the speed, and is not positive for "
        f"{negative} of the examples and channels.",
        source=sources[0].source,
        parts=tuple(_panel(forms, examples, channel) for channel in range(3)),
    )


def _negative(examples: SlipExamples) -> float:
    """Fraction of examples and channels at which (5.6) is no standard deviation."""
    std = _forms(examples)["thesis (5.6)"].predict(examples.v, examples.omega).std
    return float(np.mean(std <= 0.0))


def _forms(examples: SlipExamples) -> dict[str, LeastSquaresSurface]:
    forms = {
        "log-variance": LeastSquaresSurface(TERMS),
        "thesis (5.6)": LeastSquaresSurface(TERMS, spread="thesis"),
    }
    for form in forms.values():
        form.fit(examples)
    return forms


def _panel(forms: dict[str, LeastSquaresSurface], examples: SlipExamples, channel: int) -> Panel:
    speed = np.linspace(0.2, 2.2, 41)
    lines = [
        Line(
            speed,
            form.predict(speed, CURVATURE * speed).std[:, channel],
            name,
            colour,
            "solid" if colour == FITTED else "dash",
        )
        for (name, form), colour in zip(forms.items(), (FITTED, BASELINE), strict=True)
    ]
    left = examples.slip - forms["log-variance"].predict(examples.v, examples.omega).mean
    near = np.abs(np.abs(examples.omega / examples.v) - CURVATURE) < 0.05
    speeds = np.unique(np.round(examples.v[near], 2))
    seen = [
        np.sqrt(np.mean(np.square(left[near & (np.abs(examples.v - v) < 0.02), channel]))) for v in speeds
    ]
    points = Points(speeds, np.array(seen), label="rms residual", colour=MEASURED, size=6.0)
    return Panel(
        f"{CHANNELS[channel]}, standard deviation at {CURVATURE:g} 1/m",
        "V [m/s]",
        f"[{UNITS[channel]}]",
        (*lines, points),
    )
