# SPDX-License-Identifier: Apache-2.0
"""Chapter 4: the steady state of held commands."""

from __future__ import annotations

from collections.abc import Callable

from slipwise_thesis.chapter4_draws import drawn_paths
from slipwise_thesis.chapter4_fits import fitted_curves
from slipwise_thesis.chapter4_husky import husky_curves, husky_rates
from slipwise_thesis.chapter4_paths import collected_paths
from slipwise_thesis.chapter4_rates import angular_rates, translational_rates
from slipwise_thesis.chapter4_recovery import recovered_noise
from slipwise_thesis.chapter4_scatter import learned_scatter
from slipwise_thesis.chapter4_setup import commands, vehicle
from slipwise_thesis.chapter4_weights import compared_weights
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.thesis_figure import ThesisFigure, figure_of_log


def chapter4_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the figures and tables of the steady state, in the thesis's order."""
    steps: tuple[tuple[str, Callable[[Fixture], list[ThesisFigure]]], ...] = (
        ("path segments", lambda b: [collected_paths(b)]),
        ("slip curves", lambda b: [fitted_curves(b)]),
        ("weights", lambda b: [compared_weights(b)]),
        ("scatter", lambda b: [learned_scatter(b)]),
        ("drawn segments", drawn_paths),
        ("recovered noise", lambda b: [recovered_noise(b)]),
        ("commands", lambda b: [commands(b), vehicle()]),
        ("slip rates", lambda b: [angular_rates(b), translational_rates(b)]),
        ("a real Husky", _husky),
    )
    figures = []
    for done, (what, make) in enumerate(steps):
        progress(what, done / len(steps))
        figures += make(fixture)
    return figures


def _husky(fixture: Fixture) -> list[ThesisFigure]:
    return [
        figure_of_log(
            "figure-4-2-husky", "Figure 4.2", "Slip curves of a real Husky", lambda: husky_curves(fixture)
        ),
        figure_of_log(
            "figure-4-9-husky",
            "Figures 4.9 and 4.10",
            "Slip rates of a real Husky",
            lambda: husky_rates(fixture),
        ),
    ]
