# SPDX-License-Identifier: Apache-2.0
"""Slip rates of steady segments as examples for the surfaces of chapter 5, some commands held out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from slipwise_thesis import _thesis
from slipwise_thesis.chapter4_paths import held_paths
from slipwise_thesis.fixture import CURVATURES, Fixture, MissingLogError
from slipwise_thesis.panel import Floats
from slipwise_thesis.steady import PathRules, SlipFitRules, SteadyGroup, SteadyPath, fit_slip
from slipwise_thesis.surfaces import SlipExamples, SlipSurface, SurfacePrediction, slip_examples

HUSKY_LOG = "husky/tile_deflated_tyres"
HUSKY_RULES = PathRules(length=3.0, least_distance=0.0, settle=2.5)  # the rest of its holds of 6 s
HELD_OUT = 5  # one command of so many is not learned
# Weights of the poses of one segment: slip noise that outweighs the noise of its poses.
WEIGHTS = _thesis.SteadyNoise(np.full(3, 1e-3), np.zeros(3), np.full(3, 1e-5))
CHANNELS = ("forward", "sideways", "angular")
UNITS = ("m/s", "m/s", "rad/s")
NODES = 21  # along each axis of a surface


@dataclass(frozen=True, eq=False)
class SteadyExamples:
    """Examples of one source."""

    source: str
    learned: SlipExamples
    held_out: SlipExamples  # of commands that were not learned
    whole: SlipExamples  # both, in order of time


def simulated_examples(fixture: Fixture, terrain: str) -> SteadyExamples:
    """Return the segments of the simulated circles on one terrain."""
    circles = len(fixture.size.circle_speeds) * len(CURVATURES) * 2
    driven = f"{circles} circles of {fixture.size.circle_time:g} s"
    return examples_of(
        f"simulated Land Tamer on {terrain} terrain, {driven}", held_paths(fixture.circles(terrain).log)
    )


def husky_examples(fixture: Fixture) -> SteadyExamples:
    """Return the segments of a real Husky's held commands.

    Raises:
        MissingLogError: the log is not there.
    """
    log = fixture.real_log(HUSKY_LOG)
    return examples_of(f"real Husky, {HUSKY_LOG}, 200 held commands of 6 s", held_paths(log, HUSKY_RULES))


def all_examples(fixture: Fixture) -> list[SteadyExamples]:
    """Return the examples of both terrains and of the Husky, which is left out where its log is missing."""
    found = [simulated_examples(fixture, terrain) for terrain in ("tyre-force", "contact-friction")]
    try:
        return [*found, husky_examples(fixture)]
    except MissingLogError:
        return found


def fitted(make: Callable[[], SlipSurface], examples: SlipExamples) -> SlipSurface:
    """Return a surface fitted to examples."""
    surface = make()
    surface.fit(examples)
    return surface


def over_curvature(surface: SlipSurface, speed: Floats, curvature: Floats) -> SurfacePrediction:
    """Predict on a grid of speeds [S] and curvatures [K]; rows go through the speeds of each curvature."""
    v, kappa = np.meshgrid(speed, curvature)
    return surface.predict(v.ravel(), (v * kappa).ravel())


def examples_of(source: str, paths: Sequence[SteadyPath]) -> SteadyExamples:
    """Fit the slip rates of every segment, and hold out every fifth command."""
    drive = np.array([(path.command[0], path.command[2]) for path in paths])
    slip = np.array([_slip(path) for path in paths])
    whole = slip_examples(drive, slip)
    _, command = np.unique(np.round(drive, 3), axis=0, return_inverse=True)
    out = command.ravel() % HELD_OUT == HELD_OUT // 2
    return SteadyExamples(source, whole[~out], whole[out], whole)


def _slip(path: SteadyPath) -> Floats:
    """Slip rates of one segment, as a group of its own."""
    v, vy, omega = path.command
    return np.array(fit_slip(SteadyGroup(v, vy, omega, None, (path,)), SlipFitRules(noise=WEIGHTS)).slip)
