# SPDX-License-Identifier: Apache-2.0
"""Chapter 5: slip surfaces over speed and curvature."""

from __future__ import annotations

from collections.abc import Callable

from slipwise_thesis.chapter5_scores import score_table
from slipwise_thesis.chapter5_spread import spread_figure
from slipwise_thesis.chapter5_surfaces import REGRESSIONS, other_terrain_figure, surface_figure
from slipwise_thesis.chapter5_times import times_table
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.thesis_figure import ThesisFigure


def chapter5_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the figures and tables of the slip surfaces."""
    figures = []
    for fraction, regression in zip((0.0, 0.4, 0.45), REGRESSIONS, strict=True):
        progress(f"surfaces by {regression.title}", fraction)
        figures.append(surface_figure(fixture, regression))
    progress("contact-friction terrain", 0.5)
    figures.append(other_terrain_figure(fixture))
    progress("held-out scores", 0.8)
    figures.append(score_table(fixture))
    figures.insert(1, spread_figure(fixture))
    progress("times", 0.9)
    return [*figures, times_table(fixture)]
