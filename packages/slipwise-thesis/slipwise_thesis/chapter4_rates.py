# SPDX-License-Identifier: Apache-2.0
"""Figures 4.9 and 4.10: optimised slip rates against speed and curvature, beside the true ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.number_text import number_text
from slipwise_sim import Simulation
from slipwise_thesis.chapter4_paths import SETTLE, TERRAINS, held_paths
from slipwise_thesis.fixture import CURVATURES, Fixture
from slipwise_thesis.panel import COLOURS, INK, ErrorBars, Floats, Panel, Points, Series
from slipwise_thesis.steady import SlipRow, find_holds, group_paths, slip_table
from slipwise_thesis.thesis_figure import ThesisFigure

LABELS = ("forward slip rate [m/s]", "side slip rate [m/s]", "angular slip rate [rad/s]")
NAMES = ("forward slip", "side slip", "angular slip")
ANGULAR = 2


@dataclass(frozen=True, eq=False)
class Rates:
    """Slip rates of the circles driven to the left on one terrain, in order of curvature and speed."""

    rows: tuple[SlipRow, ...]
    truth: Floats  # [rows, 3] mean true slip rates while the command was held

    def of(self, curvature: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Return speeds [N], slip [N, 3], bars [N, 3] and truth [N, 3] of one curvature."""
        at = [i for i, row in enumerate(self.rows) if abs((row.curvature or 0.0) - curvature) < 0.02]
        rows = [self.rows[i] for i in at]
        return (
            np.array([row.v for row in rows]),
            np.array([row.slip for row in rows]),
            np.array([row.bar or (0.0, 0.0, 0.0) for row in rows]),
            self.truth[at],
        )


def circle_rates(fixture: Fixture, terrain: str) -> Rates:
    """Return the slip rates of all commands with positive curvature, as in the thesis."""
    simulation = fixture.circles(terrain)
    table = slip_table(group_paths(held_paths(simulation.log)))
    rows = tuple(row for row in table if (row.curvature or 0.0) > 0.0)
    true = _true_slip(simulation)
    return Rates(rows, np.array([true[round(row.v, 3), round(row.omega, 3)] for row in rows]))


def _true_slip(simulation: Simulation) -> dict[tuple[float, float], Floats]:
    """Mean true twist minus command, by the command (v, omega)."""
    (run,) = simulation.log.runs
    assert run.commands is not None
    truth = simulation.truth
    found = {}
    for hold in find_holds(run.commands):
        at = (truth.t >= hold.start + SETTLE) & (truth.t <= hold.end)
        twist = np.array([truth.vx[at].mean(), truth.vy[at].mean(), truth.omega[at].mean()])
        found[round(hold.v, 3), round(hold.omega, 3)] = twist - np.array([hold.v, hold.vy, hold.omega])
    return found


def rate_panel(name: str, rates: Rates, channel: int) -> Panel:
    """Draw one channel against speed, a colour per curvature."""
    series: list[Series] = []
    for curvature, colour in zip(CURVATURES, COLOURS, strict=False):
        v, slip, bar, truth = rates.of(curvature)
        label = f"κ = {curvature:g} 1/m"
        series.append(ErrorBars(v, slip[:, channel], bar[:, channel], label, colour, "dot", joined=True))
        series.append(Points(v, truth[:, channel], None, "true mean slip", INK, "ring", 9.0))
    return Panel(f"{name}: {NAMES[channel]}", "commanded speed [m/s]", LABELS[channel], tuple(series))


def angular_rates(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.9."""
    panels, linear, fractions = [], [], []
    for terrain, name in TERRAINS.items():
        rates = circle_rates(fixture, terrain)
        panels.append(rate_panel(name, rates, ANGULAR))
        linear.append(f"{_least_linear(rates, ANGULAR):.3f} on {name}")
        fraction = np.array([-row.slip[ANGULAR] / row.omega for row in rates.rows])
        fractions.append(
            f"{100 * fraction.min():.0f} to {100 * fraction.max():.0f} % of the commanded yaw rate on {name}"
        )
    return ThesisFigure(
        key="figure-4-9",
        thesis="Figure 4.9",
        title="Optimised angular slip rates for multiple curvatures",
        shows="The fitted angular slip rate against speed, per curvature, with 1-sigma bars of one "
        "segment's mean slip from the scatter; rings: what the simulated robot truly did.",
        agrees="For a constant curvature the angular slip rate is close to a line in the speed; the least "
        f"fraction of its squares that a line through the origin explains is {' and '.join(linear)}. Angular "
        f"slip is large: {' and '.join(fractions)}.",
        differs="Curvatures and speeds are not the thesis's, and the terrain is not its gravel, so only the "
        "shape can be compared. The bars are as wide as the simulated disturbance makes them. That the fit "
        "finds the true mean slip could not be seen in the thesis.",
        source=_source(fixture),
        parts=tuple(panels),
    )


def translational_rates(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.10."""
    panels, forward, side, linear, worst = [], [], [], [], np.zeros(2)
    for terrain, name in TERRAINS.items():
        rates = circle_rates(fixture, terrain)
        panels += [rate_panel(name, rates, channel) for channel in (0, 1)]
        slip, v = np.array([row.slip for row in rates.rows]), np.array([row.v for row in rates.rows])
        forward.append(f"{100 * np.abs(slip[:, 0] / v).max():.1f} % of the speed on {name}")
        side.append(
            f"{number_text(np.abs(slip[:, 1]).max())} m/s ({100 * np.abs(slip[:, 1] / v).max():.1f} % of "
            f"the speed) on {name}"
        )
        linear.append(f"{' and '.join(f'{_least_linear(rates, k):.2f}' for k in (0, 1))} on {name}")
        off = np.abs(slip - rates.truth)[:, :2]
        sigma = np.array([row.sigma for row in rates.rows])[:, :2]
        worst = np.maximum(worst, (off.max(), (off / sigma).max()))
    return ThesisFigure(
        key="figure-4-10",
        thesis="Figure 4.10",
        title="Optimised translational slip rates for multiple curvatures",
        shows="The fitted forward and side slip rates against speed, per curvature, with 1-sigma bars of "
        "one segment's mean slip; rings: what the simulated robot truly did.",
        agrees=f"Forward slip is at most {' and '.join(forward)}. Of the squares of forward and side slip "
        f"at one curvature, a line through the origin explains as little as {' and '.join(linear)}: they are "
        f"not linear in the speed. All fits are within {number_text(1000 * worst[0], 2)} mm/s of the truth, "
        f"{worst[1]:.1f} of their standard deviations at the most.",
        differs="The thesis finds side slip insignificant and close to constant. Here it grows with speed "
        f"times yaw rate, as a centripetal force asks for, to {' and '.join(side)}: this is the term V ω "
        "that the thesis's basis (5.1) lacks. Its speeds were probably too low to see it.",
        source=_source(fixture),
        parts=tuple(panels),
    )


def _least_linear(rates: Rates, channel: int) -> float:
    """The least fraction of squares, over the curvatures, that slip proportional to speed explains."""
    fractions = []
    for curvature in CURVATURES:
        v, slip, _, _ = rates.of(curvature)
        rate = slip[:, channel]
        slope = float(v @ rate / (v @ v))
        fractions.append(1.0 - float(np.sum((rate - slope * v) ** 2) / np.sum(rate**2)))
    return min(fractions)


def _source(fixture: Fixture) -> str:
    return (
        f"simulated Land Tamer (MuJoCo), every command held for {fixture.size.circle_time:g} s, the segments "
        "of figure 4.7 with positive curvature"
    )
