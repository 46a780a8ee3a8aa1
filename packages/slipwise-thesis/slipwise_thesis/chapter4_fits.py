# SPDX-License-Identifier: Apache-2.0
"""Figure 4.2: slip with and without its angular part, beside a polynomial."""

from __future__ import annotations

from slipwise.number_text import number_text
from slipwise_thesis.chapter4_paths import TERRAINS, circle_group, circle_source, curve_line
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, IDEAL, INK, Panel, paths_line
from slipwise_thesis.steady import FitComparison, SteadyGroup, compare_fits
from slipwise_thesis.thesis_figure import ThesisFigure

NAMES = {
    "no slip": "no slip",
    "translation": "forward and side slip only",
    "three channels": "three degrees of freedom",
    "polynomial": "second-order polynomial",
}
COLUMNS = (
    "terrain",
    "curve",
    "cost (4.1) [m²]",
    "rms position [m]",
    "rms heading [rad]",
    "from polynomial [m]",
)


def fit_panel(title: str, group: SteadyGroup, fits: FitComparison) -> Panel:
    """Draw the segments with the four curves."""
    return Panel(
        title,
        "x, forward [m]",
        "y, left [m]",
        (
            paths_line([path.poses for path in group.paths], label="measured"),
            curve_line(fits.curve("no slip").path, NAMES["no slip"], IDEAL),
            curve_line(fits.curve("translation").path, NAMES["translation"], BASELINE, "dashdot"),
            curve_line(fits.curve("three channels").path, NAMES["three channels"], INK, "solid"),
            curve_line(fits.curve("polynomial").path, NAMES["polynomial"], FITTED),
        ),
        equal_axes=True,
    )


def fit_rows(terrain: str, fits: FitComparison) -> list[tuple[str, ...]]:
    """Return a row of numbers per curve."""
    apart = {"translation": fits.translation_to_polynomial, "three channels": fits.to_polynomial}
    return [
        (
            terrain,
            NAMES[curve.name],
            number_text(curve.cost),
            number_text(curve.rms_position),
            number_text(curve.rms_heading),
            number_text(apart[curve.name]) if curve.name in apart else "",
        )
        for curve in fits.curves
    ]


def fitted_curves(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.2."""
    panels, rows, sentences = [], [], []
    for terrain, name in TERRAINS.items():
        group = circle_group(fixture, terrain)
        fits = compare_fits(group)
        panels.append(fit_panel(name, group, fits))
        rows += fit_rows(name, fits)
        sentences.append(
            f"On {name}, the path with three degrees of freedom lies "
            f"{number_text(1000 * fits.to_polynomial)} mm rms from the polynomial, that with forward and "
            f"side slip only {number_text(1000 * fits.translation_to_polynomial)} mm, and its cost is "
            f"{number_text(fits.curve('translation').cost / fits.curve('three channels').cost)} times as "
            "high."
        )
    return ThesisFigure(
        key="figure-4-2",
        thesis="Figure 4.2",
        title="Optimised slip curves",
        shows="The segments of figure 4.1 with the best constant slip rates: forward and side slip only, "
        "as in (a), and with angular slip, as in (b); the polynomial; their residuals over all poses.",
        agrees=f"{' '.join(sentences)}",
        differs="The thesis's figure has no numbers; these are the cost (4.1) with the weight L² (L = 1 m, "
        "heading wrapped) and root mean squares. The cost falls so far because the heading is measured "
        "too: side slip can bend the path's ends to the right place, but never turns the robot.",
        source=circle_source(fixture),
        parts=(*panels, Grid("Residuals", COLUMNS, tuple(rows))),
    )
