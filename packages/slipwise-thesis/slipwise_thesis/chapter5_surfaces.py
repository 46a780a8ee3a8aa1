# SPDX-License-Identifier: Apache-2.0
"""Figures 5.1 to 5.3: slip surfaces by least squares, Gaussian process and Bayesian linear regression."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from slipwise import _core
from slipwise.number_text import number_text
from slipwise_thesis.chapter5_examples import (
    CHANNELS,
    NODES,
    UNITS,
    fitted,
    husky_examples,
    over_curvature,
    simulated_examples,
)
from slipwise_thesis.fixture import Fixture, MissingLogError
from slipwise_thesis.panel import INK, Floats, Panel, Points, Surface
from slipwise_thesis.surfaces import (
    BayesianSurface,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipExamples,
    SlipSurface,
    SurfacePrediction,
)
from slipwise_thesis.thesis_figure import ThesisFigure

TERMS = _core.named_basis("thesis-15")  # those of (5.1)
STILL_TERMS = _core.named_basis("odd-even-10")  # where the robot also turns in place


@dataclass(frozen=True)
class Regression:
    """One way to learn surfaces."""

    key: str
    thesis: str
    title: str
    make: Callable[[_core.Basis], SlipSurface]


LEAST_SQUARES = Regression("figure-5-1", "Figure 5.1", "least squares", LeastSquaresSurface)
PROCESS = Regression("figure-5-2", "Figure 5.2", "Gaussian process", lambda _: GaussianProcessSurface())
BAYESIAN = Regression("figure-5-3", "Figure 5.3", "Bayesian linear regression", BayesianSurface)
REGRESSIONS = (LEAST_SQUARES, PROCESS, BAYESIAN)


def surface_figure(fixture: Fixture, regression: Regression) -> ThesisFigure:
    """Make figure 5.1, 5.2 or 5.3."""
    examples = simulated_examples(fixture, "tyre-force")
    surface = fitted(lambda: regression.make(TERMS), examples.whole)
    parts = [curvature_panel(surface, examples.whole, channel, name) for channel, name in enumerate(CHANNELS)]
    sources = [examples]
    try:
        sources.append(husky_examples(fixture))
    except MissingLogError as error:
        missing = f"; {error}"
    else:
        real, missing = fitted(lambda: regression.make(STILL_TERMS), sources[1].whole), ""
        parts.append(yaw_rate_panel(real, sources[1].whole, 2, "angular, real Husky"))
    at = surface.predict(examples.whole.v, examples.whole.omega)
    return ThesisFigure(
        key=regression.key,
        thesis=regression.thesis,
        title=f"Slip surfaces by {regression.title}",
        shows="Each dot is the slip rate of one segment of 3 s; the coloured surface is the mean, the grey "
        "sheets lie one standard deviation of a segment away.",
        agrees=_agrees(regression, examples.whole, at),
        differs=_differs(regression),
        source="; ".join(s.source for s in sources) + missing,
        parts=tuple(parts),
    )


def other_terrain_figure(fixture: Fixture) -> ThesisFigure:
    """Draw the angular slip rate by all three on the terrain of another author."""
    examples = simulated_examples(fixture, "contact-friction")
    surfaces = [fitted(partial(regression.make, TERMS), examples.whole) for regression in REGRESSIONS]
    means = [surface.predict(examples.whole.v, examples.whole.omega).mean[:, 2] for surface in surfaces]
    _, process, bayesian = (np.sqrt(np.mean(np.square(mean - means[0]))) for mean in means)
    size = np.sqrt(np.mean(np.square(examples.whole.slip[:, 2])))
    return ThesisFigure(
        key="figure-5-contact",
        thesis="Figures 5.1 to 5.3",
        title="Angular slip surfaces on contact-friction terrain",
        shows="The angular slip rate by the three regressions, as above.",
        agrees=f"The three give similar results: from least squares, the Gaussian process is "
        f"{number_text(process, 2)} rad/s rms away and Bayesian regression {number_text(bayesian, 2)}, of a "
        f"slip rate of {number_text(size, 2)} rad/s rms.",
        differs="The terrain is MuJoCo's own friction, whose slip follows no law that a basis holds. "
        "The thesis has one terrain.",
        source=examples.source,
        parts=tuple(
            curvature_panel(surface, examples.whole, 2, regression.title)
            for surface, regression in zip(surfaces, REGRESSIONS, strict=True)
        ),
    )


def curvature_panel(surface: SlipSurface, examples: SlipExamples, channel: int, title: str) -> Panel:
    """Draw one channel over speed and curvature, as the thesis does."""
    kappa = examples.omega / examples.v
    speed = np.linspace(examples.v.min(), examples.v.max(), NODES)
    curvature = np.linspace(kappa.min(), kappa.max(), NODES)
    prediction = over_curvature(surface, speed, curvature)
    points = Points(examples.v, kappa, examples.slip[:, channel], colour=INK, size=3.0)
    return _solid(title, "κ [1/m]", prediction, (speed, curvature, channel), points)


def yaw_rate_panel(surface: SlipSurface, examples: SlipExamples, channel: int, title: str) -> Panel:
    """Draw one channel over speed and yaw rate, where turns in place have no curvature."""
    speed = np.linspace(examples.v.min(), examples.v.max(), NODES)
    yaw_rate = np.linspace(examples.omega.min(), examples.omega.max(), NODES)
    v, omega = np.meshgrid(speed, yaw_rate)
    prediction = surface.predict(v.ravel(), omega.ravel())
    points = Points(examples.v, examples.omega, examples.slip[:, channel], colour=INK, size=3.0)
    return _solid(title, "ω [rad/s]", prediction, (speed, yaw_rate, channel), points)


def _solid(
    title: str, y_label: str, prediction: SurfacePrediction, grid: tuple[Floats, Floats, int], points: Points
) -> Panel:
    x, y, channel = grid
    shape = (len(y), len(x))
    mean, std = prediction.mean[:, channel].reshape(shape), prediction.std[:, channel].reshape(shape)
    return Panel(
        title,
        "V [m/s]",
        y_label,
        (Surface(x, y, mean, std), points),
        z_label=f"slip rate [{UNITS[channel]}]",
    )


def _agrees(regression: Regression, examples: SlipExamples, prediction: SurfacePrediction) -> str:
    size = np.sqrt(np.mean(np.square(examples.slip), axis=0))
    said = (
        "The angular slip rate varies the most: "
        f"{number_text(size[2])} rad/s rms, beside {number_text(size[0])} m/s forward and "
        f"{number_text(size[1])} m/s sideways. "
    )
    if regression is LEAST_SQUARES:
        left = np.sqrt(np.mean(np.square(examples.slip - prediction.mean), axis=0))
        return said + (
            f"The five terms per channel leave {number_text(left[0])}, {number_text(left[1])} m/s and "
            f"{number_text(left[2])} rad/s rms."
        )
    plain = fitted(lambda: LEAST_SQUARES.make(TERMS), examples).predict(examples.v, examples.omega)
    away = np.sqrt(np.mean(np.square(plain.mean - prediction.mean), axis=0))
    return said + (
        f"The surface is much like that of least squares: rms differences at the examples are "
        f"{number_text(away[0])}, {number_text(away[1])} m/s and {number_text(away[2])} rad/s."
    )


def _differs(regression: Regression) -> str:
    if regression is LEAST_SQUARES:
        return (
            "Standard deviations come from the logarithm of squared residuals; the next figure has the form "
            "(5.6) beside them. The Husky's surface has the terms of odd-even-10 over the yaw rate, since "
            "a turn in place has no curvature."
        )
    if regression is PROCESS:
        return (
            "The kernel is anisotropic (Matérn 3/2) with learned lengths and learned noise, which (5.9) and "
            "(5.10) leave out; at rest it may say some slip, since nothing forbids it."
        )
    return (
        "The noise is learned with the weights (normal-inverse-gamma; Student-t prediction) where the thesis "
        "tunes it by hand; signs and transposes of (5.12) and (5.14) are corrected."
    )
