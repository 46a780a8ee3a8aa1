# SPDX-License-Identifier: Apache-2.0
"""Figure 4.3: slip noise and P0 learned from the scatter of segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.number_text import number_text
from slipwise_thesis import _thesis
from slipwise_thesis.chapter4_paths import TERRAINS, circle_group, circle_source, curve_line
from slipwise_thesis.fixture import DISTURBANCE, STD_XY, STD_YAW, Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, INK, Floats, Line, Panel, outline, paths_line
from slipwise_thesis.steady import (
    NoiseRules,
    SteadyGroup,
    fit_group_noise,
    fit_slip,
    scatter_group,
    slip_path,
    slipped_twist,
)
from slipwise_thesis.thesis_figure import ThesisFigure

TIMES = 6  # at which the scatter is looked at
POSE = (STD_XY, STD_XY, STD_YAW)
RULES = {
    "(4.13) around the mean": NoiseRules(objective=_thesis.NoiseObjective.Thesis),
    "(4.13) around the curve": NoiseRules(
        objective=_thesis.NoiseObjective.Thesis, centre=_thesis.ScatterCentre.Curve
    ),
    "Fisher scoring": NoiseRules(),
    "Fisher scoring, pose noise known": NoiseRules(pose_std=POSE),
    "Fisher scoring, known, two times": NoiseRules(times=2, pose_std=POSE),
}
THESIS = "(4.13) around the mean"


@dataclass(frozen=True, eq=False)
class LearnedNoise:
    """One way of learning the noise of a group, and the spread that it predicts."""

    noise: _thesis.SteadyNoise
    times: Floats  # [K] s
    covariances: Floats  # [K, 3, 3] of the charts at the times, the poses' own noise included if it was known


def learned_noise(group: SteadyGroup, rules: NoiseRules) -> LearnedNoise:
    """Learn the noise of one group."""
    noise = fit_group_noise([group], rules).noise
    times = float(group.paths[0].times[-1]) * np.arange(1, TIMES + 1) / TIMES
    twist = slipped_twist(group, np.array(fit_slip(group).slip))
    return LearnedNoise(noise, times, _blocks(np.array(_thesis.steady_covariance(twist, times, noise))))


def measured_scatter(group: SteadyGroup) -> Floats:
    """Return the scatter matrices (4.9) at the times, [K, 3, 3]."""
    stacked = _thesis.scatter_matrix(scatter_group(group, TIMES), _thesis.ScatterCentre.Mean)
    return _blocks(np.array(stacked))


def _blocks(stacked: Floats) -> Floats:
    return np.array([stacked[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] for k in range(len(stacked) // 3)])


def spread_panel(title: str, group: SteadyGroup, learned: LearnedNoise) -> Panel:
    """Draw segments, 1-sigma ellipses and the curves of the slip plus and minus one sigma."""
    slip = np.array(fit_slip(group).slip)
    times = np.linspace(0.0, float(learned.times[-1]), 31)
    sigma = np.sqrt(np.array(learned.noise.psd) / learned.times[-1])
    nodes = slip_path(group, slip, np.concatenate(([0.0], learned.times)))
    lines: list[Line] = [paths_line([path.poses for path in group.paths], label="measured")]
    lines += [
        curve_line(slip_path(group, slip + sign * sigma, times), "slip ± one sigma", FITTED)
        for sign in (1, -1)
    ]
    lines += [
        outline(node[:2], scatter[:2, :2], label="scatter, 1 sigma", colour=INK)
        for node, scatter in zip(nodes[1:], measured_scatter(group), strict=True)
    ]
    spread = [np.diag(np.array(learned.noise.start)), *learned.covariances]
    lines += [
        outline(node[:2], covariance[:2, :2], label="learned, 1 sigma", colour=BASELINE)
        for node, covariance in zip(nodes, spread, strict=True)
    ]
    return Panel(title, "x, forward [m]", "y, left [m]", tuple(lines))


def learned_scatter(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.3."""
    panels, rows, ends = [], [], []
    for terrain, name in TERRAINS.items():
        group = circle_group(fixture, terrain)
        scatter = measured_scatter(group)[-1]
        for rule, rules in RULES.items():
            learned = learned_noise(group, rules)
            if rule == THESIS:
                panels.append(spread_panel(f"{name}, objective (4.13)", group, learned))
            ratio = np.diag(learned.covariances[-1]) / np.diag(scatter)
            ends.append((rule, ratio))
            cells = (*np.array(learned.noise.psd), *np.array(learned.noise.start))
            spread = " / ".join(f"{value:.2f}" for value in ratio)
            rows.append((name, rule, *(number_text(1e4 * value, 2) for value in cells), spread))
        gain = 1.0 + float(np.array(fit_slip(group).slip)[2]) / group.omega
        truth = (
            0.05 * DISTURBANCE[0] ** 2,
            0.0,
            0.05 * (gain * DISTURBANCE[1]) ** 2,
            STD_XY**2,
            STD_XY**2,
            STD_YAW**2,
        )
        rows.append((name, "as simulated", *(number_text(1e4 * value, 2) for value in truth), ""))
    thesis, curve, blind, fisher, coarse = (_range(ends, rule) for rule in RULES)
    channels = ("q forward", "q side", "q angular", "P0 x", "P0 y", "P0 θ")
    return ThesisFigure(
        key="figure-4-3",
        thesis="Figure 4.3",
        title="Segments with uncertainty learned by the scatter matrix",
        shows="Measured segments, the scatter's 1-sigma ellipses at six times, and those of the learned "
        "slip noise and P0; the first is P0's alone. Dashed: the paths of the slip rates plus and minus "
        "one sigma.",
        agrees="Slip noise and an uncertain start explain how segments spread: of the variances at the "
        f"end, those by (4.13) are {thesis} of the measured. With the scatter around the best-fit curve "
        f"instead of the mean they are {curve}.",
        differs="The thesis counts Δt twice and calls the slip noise a variance; here q is a density. One "
        "sigma of a segment's mean slip rate is √(q/T). Slip noise is taken as white, and that of a "
        "vehicle with a lag of 0.81 s is not: Fisher scoring, which uses how a segment's poses belong "
        f"together, gives {fisher} of the variance at the end when it looks at {TIMES} times, and {coarse} "
        "when at two. Where the poses' own noise is not known to it, it takes this for slip noise: "
        f"{blind}. None was simulated to the side.",
        source=circle_source(fixture),
        parts=(
            *panels,
            Grid(
                "Learned noise, in 10⁻⁴ of m²/s, rad²/s, m² and rad²",
                ("terrain", "by", *channels, "variance at the end, learned over measured: x / y / θ"),
                tuple(rows),
                note="As simulated: the disturbance of the commands, its angular part reduced by the "
                "measured slip, and the noise of the first pose.",
            ),
        ),
    )


def _range(ends: list[tuple[str, Floats]], wanted: str) -> str:
    """Say the range of a rule's ratios."""
    ratios = np.concatenate([ratio for rule, ratio in ends if rule == wanted])
    return f"{ratios.min():.2f} to {ratios.max():.2f}"
