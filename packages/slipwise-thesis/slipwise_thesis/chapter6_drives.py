# SPDX-License-Identifier: Apache-2.0
"""Figures 6.1 and 6.2: the perturbative simulator beside rigid-body physics, under the same commands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipwise import _core
from slipwise.logs import Inputs
from slipwise.number_text import number_text
from slipwise_sim import Perturbation, Scenario, Truth, simulate
from slipwise_thesis.chapter5_examples import fitted, simulated_examples
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.panel import FITTED, IDEAL, INK, MEASURED, Dash, Floats, Line, Panel, paths_line
from slipwise_thesis.surfaces import BayesianSurface, LeastSquaresSurface
from slipwise_thesis.thesis_figure import ThesisFigure

BASIS = _core.named_basis("odd-even-10")
HELD = (
    (1.0, 0.0, 6.0),
    (1.0, 0.3, 12.0),
    (1.5, -0.3, 12.0),
    (0.75, 0.0, 4.0),
    (1.5, 0.6, 8.0),
)  # v, omega, s
DRAWS = 20  # perturbed drives
TERRAIN = "tyre-force"
LOOKS: dict[str, tuple[str, Dash, float]] = {
    "perturbed drive": (FITTED, "solid", 0.8),
    "rigid-body physics": (MEASURED, "solid", 1.6),
    "mean surfaces": (INK, "dot", 2.0),
}
NAMES = ("forward [m/s]", "sideways [m/s]", "angular [rad/s]")


class SimplePath:
    """The simple path of figure 6.1, driven four ways."""

    def __init__(self, fixture: Fixture) -> None:
        """Fit the surfaces and drive."""
        examples = simulated_examples(fixture, TERRAIN)
        self.source = examples.source
        surface = fitted(lambda: LeastSquaresSurface(BASIS), examples.whole)
        none = fitted(lambda: BayesianSurface(_core.Basis("none", [], [], [])), examples.whole)
        self.commands = _commands()
        duration = sum(seconds for *_, seconds in HELD)
        plain = Scenario(duration=duration, commands=self.commands, terrain=TERRAIN)
        drawn = replace(plain, perturbation=Perturbation(surface))
        self.ideal = simulate(replace(plain, perturbation=Perturbation(none, spread=0.0)), seed=0).truth
        self.mean = simulate(replace(plain, perturbation=Perturbation(surface, spread=0.0)), seed=0).truth
        self.draws = [simulate(drawn, seed=fixture.seed + place).truth for place in range(DRAWS)]
        self.physics = simulate(plain, seed=fixture.seed).truth
        self.driven = dict(zip(LOOKS, (self.draws[0], self.physics, self.mean), strict=True))


def path_figure(path: SimplePath) -> ThesisFigure:
    """Make figure 6.1."""
    physics, mean, ideal = (_places(truth) for truth in (path.physics, path.mean, path.ideal))
    ends = np.array([_places(truth)[-1] for truth in path.draws])
    spread = np.sqrt(np.trace(np.cov(ends[:, :2].T)))
    lengths = np.hypot(path.physics.vx, path.physics.vy)[:-1].sum() * float(path.physics.t[1])
    series = (
        paths_line(
            [_places(truth) for truth in path.draws], label=f"{DRAWS} perturbed drives", colour=FITTED
        ),
        Line(ideal[:, 0], ideal[:, 1], "ideal: commands without slip", IDEAL, "dash", 2.2),
        Line(mean[:, 0], mean[:, 1], "mean surfaces", INK, "dot", 2.2),
        Line(physics[:, 0], physics[:, 1], "rigid-body physics", MEASURED, width=2.2),
    )
    return ThesisFigure(
        key="figure-6-1",
        thesis="Figure 6.1",
        title="Simulated path beside the ideal one",
        shows="The same commands four ways: without slip, with the slip surfaces of figure 5.1's segments, "
        "with their variance as perturbation, and in the physics that the surfaces were learned from.",
        agrees=f"With slip the vehicle ends {_away(mean, ideal)} from the ideal end after "
        f"{number_text(lengths)} m. The perturbative simulator is plausible: physics ends "
        f"{_away(physics, mean)} from the drive by the mean surfaces, and {_away(physics, ideal)} from the "
        f"ideal end. Perturbed drives scatter by {number_text(spread)} m at the end.",
        differs="The surfaces are of the steady state and know no lag: physics starts each manoeuvre late "
        "(0.16 s delay, 0.81 s lag), which they cannot show. The thesis had no physics to compare with.",
        source=path.source,
        parts=(Panel("path", "x [m]", "y [m]", series, equal_axes=True),),
    )


def perturbation_figure(path: SimplePath) -> ThesisFigure:
    """Make figure 6.2."""
    commanded = _commanded(path.commands, path.physics.t)
    slips = {name: _slip(truth, commanded) for name, truth in path.driven.items()}
    settled = _settled(path.physics.t)
    away = np.sqrt(np.mean(np.square(slips["rigid-body physics"] - slips["mean surfaces"])[settled], axis=0))
    size = np.sqrt(np.mean(np.square(slips["mean surfaces"])[settled], axis=0))
    return ThesisFigure(
        key="figure-6-2",
        thesis="Figure 6.2",
        title="Commands and perturbations",
        shows="Commanded speed and curvature, and the slip rates: of one perturbed drive, of the mean "
        "surfaces, and of physics (its velocity less the commanded one).",
        agrees="Once a manoeuvre has settled for 3 s, the slip rates of physics differ from the mean "
        f"surfaces by {number_text(away[0], 2)}, {number_text(away[1], 2)} m/s and {number_text(away[2], 2)} "
        f"rad/s rms, of {number_text(size[0], 2)}, {number_text(size[1], 2)} m/s and "
        f"{number_text(size[2], 2)} rad/s.",
        differs="The noise is white with a density that gives one segment's mean the surface's standard "
        "deviation, so it does not depend on the sampling time (the thesis states none). In physics the "
        "transients of the drive show as large slip for two seconds.",
        source=path.source,
        parts=(_command_panel(path.physics.t, commanded), *_slip_panels(path.physics.t, slips)),
    )


def _command_panel(times: Floats, commanded: Floats) -> Panel:
    v, omega = commanded[:, 0], commanded[:, 2]
    lines = (Line(times, v, "V"), Line(times, omega / v, "κ"))
    return Panel("commands", "time [s]", "V [m/s], κ [1/m]", lines)


def _slip_panels(times: Floats, slips: dict[str, Floats]) -> list[Panel]:
    """A panel per channel, with the slip rates [N, 3] of every drive."""
    return [
        Panel(
            name,
            "time [s]",
            f"slip rate, {name}",
            tuple(Line(times, slip[:, channel], label, *LOOKS[label]) for label, slip in slips.items()),
        )
        for channel, name in enumerate(NAMES)
    ]


def _commands() -> Inputs:
    """The commands of HELD at 20 Hz."""
    v = np.concatenate([np.full(round(20 * seconds), speed) for speed, _, seconds in HELD])
    omega = np.concatenate([np.full(round(20 * seconds), rate) for _, rate, seconds in HELD])
    return Inputs(t=np.arange(len(v)) / 20.0, v=v, vy=np.zeros_like(v), omega=omega)


def _commanded(commands: Inputs, times: Floats) -> Floats:
    """Commanded twists at the times, [N, 3]."""
    at = np.searchsorted(commands.t, times + 1e-9, side="right") - 1
    return np.column_stack((commands.v, commands.vy, commands.omega))[at]


def _settled(times: Floats) -> Floats:
    """Mask of the times at which a manoeuvre has lasted for 3 s."""
    starts = np.cumsum([0.0, *(seconds for *_, seconds in HELD)])[:-1]
    return np.asarray(times - starts[np.searchsorted(starts, times + 1e-9, side="right") - 1] > 3.0)


def _places(truth: Truth) -> Floats:
    return np.column_stack((truth.x, truth.y))


def _slip(truth: Truth, commanded: Floats) -> Floats:
    return np.column_stack((truth.vx, truth.vy, truth.omega)) - commanded


def _away(a: Floats, b: Floats) -> str:
    return f"{number_text(float(np.hypot(*(a[-1] - b[-1]))))} m"
