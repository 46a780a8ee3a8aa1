# SPDX-License-Identifier: Apache-2.0
"""Chapter 2: related models compared, on a terrain with the traction law that the thesis cites."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipwise.calibration import make_settings
from slipwise.evaluation import Evaluation, EvaluationOptions, evaluate
from slipwise.number_text import number_text
from slipwise_sim import LandTamer, TractionLaw, traction_force
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, Bars, Line, Panel
from slipwise_thesis.thesis_figure import ThesisFigure

TERRAIN = "traction-law"
HORIZONS = (2.0, 5.0)  # [s]
METHODS = {
    "none": "kinematic baseline",
    "icr-3": "centre of rotation (2.3)",
    "slip-ratio-ekf": "slip ratios, EKF (2.5-2.7)",
    "slip-ratio-smo": "slip ratios, observer (2.5-2.7)",
    "full-linear-6": "slip rates linear in V, ω",
    "auto": "slipwise's default",
}


def chapter2_figures(fixture: Fixture, progress: Callable[[str, float], None]) -> list[ThesisFigure]:
    """Make the figures and tables of the related models."""
    progress("the traction law", 0.0)
    law = traction_law()
    progress("related models", 0.05)
    return [law, related_models(fixture)]


def traction_law() -> ThesisFigure:
    """Draw (2.8) and (2.9) as the simulator applies them."""
    law, one = TractionLaw(), np.ones(121)
    sliding = np.linspace(-0.6, 0.6, 121)
    still = np.zeros((2, 121))
    free = TractionLaw(rolling=0.0, rolling_slope=0.0)
    pull = traction_force(free, one, still, sliding)[0]
    sideways = traction_force(free, one, np.stack((np.zeros(121), np.full(121, 0.2))), sliding)[0]
    rolling = traction_force(law, one, np.stack((sliding, np.zeros(121))), sliding)[0]
    traction = Panel(
        "Traction (2.8)",
        "sliding speed of the wheel r ω - v [m/s]",
        "forward force / load [1]",
        (
            Line(sliding, pull, "as printed", FITTED),
            Line(sliding, sideways, "while sliding sideways at 0.2 m/s", BASELINE, "dash"),
        ),
    )
    resistance = Panel(
        "Rolling resistance (2.9)",
        "speed of the wheel [m/s]",
        "forward force / load [1]",
        (Line(sliding, rolling, "", FITTED),),
    )
    left = 100 * float(sideways[-1] / pull[-1])
    return ThesisFigure(
        key="equation-2-8",
        thesis="Equations 2.8 and 2.9",
        title="The explicit traction and rolling-resistance law",
        shows="Force of the terrain on a wheel over its sliding speed, and its drag over its speed.",
        agrees="Along the wheel both laws are as printed, smooth at zero speed, and saturate.",
        differs="(2.8) is a law of the forward sliding speed alone, so that a skid-steered vehicle would "
        f"not be held sideways. The vector of sliding takes its place: at 0.2 m/s sideways, {left:.0f} % of "
        f"the forward force at {sliding[-1]:g} m/s are left. The constants are those of a plausible terrain.",
        source="slipwise_sim.traction_force with its default constants",
        parts=(traction, resistance),
    )


def related_models(fixture: Fixture) -> ThesisFigure:
    """Compare the models of section 2.3 where the terrain follows (2.8) and (2.9)."""
    settings = make_settings({"log": {"wheel_separation": LandTamer().wheel_separation}})
    options = EvaluationOptions(HORIZONS, tuple(METHODS))
    result = evaluate(fixture.long_drive(TERRAIN).log, input="wheel", settings=settings, options=options)
    last = result.horizons[-1]
    names = tuple(METHODS.values())
    panels = [
        Panel(
            title,
            "",
            unit,
            (Bars(names, np.array([getattr(result.score(m, last), which).mean for m in METHODS])),),
        )
        for title, unit, which in (
            (f"Position after {last:g} s", "mean error [m]", "position"),
            (f"Heading after {last:g} s", "mean error [rad]", "heading"),
        )
    ]
    ratio = {method: result.score(method, last).position_ratio[0] for method in METHODS}
    ratios = {method: f"{number_text(ratio[method])} times" for method in METHODS}
    windows = result.score("none", last).windows
    return ThesisFigure(
        key="equation-2-3",
        thesis="Equations 2.1 to 2.7",
        title="Models of related work compared",
        shows=f"Mean errors of predictions over {last:g} s from wheel speeds, made before their own data "
        f"was learned, over the {windows} windows of the drive's second half.",
        agrees=f"The models of section 2.3 can be learned from poses while driving. After {last:g} s the "
        f"centre of rotation has {ratios['icr-3']} the position error of the kinematic baseline, slip rates "
        f"that are linear in V and ω {ratios['full-linear-6']}, slipwise's default {ratios['auto']}.",
        differs="The thesis cites these models without numbers, (2.6) and (2.7) with errors; they are used "
        f"with their signs corrected. Slip ratios and a slip angle have {ratios['slip-ratio-ekf']} (EKF) "
        f"and {ratios['slip-ratio-smo']} (sliding-mode observer) the error: one ratio per side stands for "
        "the loss of speed and of turning, and a skid-steered robot loses half its turning and none of its "
        "speed.",
        source=f"simulated Land Tamer on {TERRAIN} terrain, {fixture.size.long_time:g} s of circles, random "
        "driving",
        parts=(*panels, _scores(result)),
    )


def _scores(result: Evaluation) -> Grid:
    columns = ["model"]
    columns += [
        f"{what}, {h:g} s" for h in result.horizons for what in ("position [m]", "heading [rad]", "NIS")
    ]
    rows = []
    for method, name in METHODS.items():
        scores = [result.score(method, horizon) for horizon in result.horizons]
        cells = [c for s in scores for c in (s.position.mean, s.heading.mean, s.nis)]
        rows.append((name, *(number_text(cell) for cell in cells)))
    note = "NIS is 3 where the reported covariance is true; that of the observer is the noise shape alone."
    return Grid("Mean errors", tuple(columns), tuple(rows), note)
