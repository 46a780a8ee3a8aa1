# SPDX-License-Identifier: Apache-2.0
"""Chapter 6: learning on-line, in transients."""

from __future__ import annotations

from collections.abc import Callable

from slipwise_thesis.chapter6_circling import circling
from slipwise_thesis.chapter6_convergence import descent_figure, filter_figure, residual_figure
from slipwise_thesis.chapter6_drives import SimplePath, path_figure, perturbation_figure
from slipwise_thesis.chapter6_jacobian import jacobian_figure
from slipwise_thesis.chapter6_recording import Course, record
from slipwise_thesis.chapter6_smoothing import smoothing_figure
from slipwise_thesis.chapter6_table import error_table
from slipwise_thesis.chapter6_uncertainty import correlation_figure, learned_surface_figure
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.thesis_figure import ThesisFigure

TERRAIN = "tyre-force"


def chapter6_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the figures and tables of on-line learning."""
    progress("perturbative simulator", 0.0)
    path = SimplePath(fixture)
    figures = [path_figure(path), perturbation_figure(path)]
    progress("estimators of the thesis", 0.35)
    figures += _courses(fixture)
    for fraction, terrain in ((0.6, "tyre-force"), (0.8, "contact-friction")):
        progress(f"Table 6.2 on {terrain} terrain", fraction)
        figures.append(error_table(fixture, terrain))
    return figures


def _courses(fixture: Fixture) -> list[ThesisFigure]:
    """Figures 6.3 to 6.7, with the terms of (6.10) from wheel speeds."""
    log = circling(fixture, TERRAIN)
    source = (
        f"simulated Land Tamer on {TERRAIN} terrain, {fixture.size.long_time:g} s of circles at various "
        "speeds and curvatures from zero, wheel speeds as input"
    )
    descent, filtered, correct = (
        record(log, Course(name)) for name in ("gradient-descent", "ekf-thesis", "iekf")
    )
    return [
        residual_figure(descent, source),
        descent_figure(descent, source),
        smoothing_figure(fixture.seed, fixture.size.long_time),
        filter_figure(filtered, descent, source),
        jacobian_figure(filtered, log, source),
        correlation_figure(filtered, correct, source),
        learned_surface_figure(filtered, correct, source),
    ]
