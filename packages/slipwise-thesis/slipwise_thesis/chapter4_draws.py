# SPDX-License-Identifier: Apache-2.0
"""Figures 4.4 to 4.6: new segments drawn from the learned noise, with P0 alone and slip noise alone."""

from __future__ import annotations

import numpy as np

from slipwise_thesis.chapter4_paths import TERRAINS, circle_group, circle_source, curve_line
from slipwise_thesis.chapter4_scatter import (
    RULES,
    THESIS,
    LearnedNoise,
    learned_noise,
    measured_scatter,
)
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.panel import BASELINE, FITTED, INK, Floats, Panel, outline, paths_line
from slipwise_thesis.steady import (
    DrawnPaths,
    DrawRules,
    SteadyGroup,
    draw_paths,
    fit_slip,
    slip_path,
    slipped_twist,
)
from slipwise_thesis.thesis_figure import ThesisFigure

COUNT = 100
KINDS = (
    ("4-4", "4.4", "Generated path segments", "the learned P0 and slip noise", DrawRules(count=COUNT)),
    ("4-5", "4.5", "Terminal spread due to the start", "P0 alone", DrawRules(count=COUNT, process=False)),
    (
        "4-6",
        "4.6",
        "Terminal spread due to process noise",
        "slip noise alone",
        DrawRules(count=COUNT, start=False),
    ),
)


def drawn_paths(fixture: Fixture) -> list[ThesisFigure]:
    """Make figures 4.4 to 4.6."""
    groups = {name: circle_group(fixture, terrain) for terrain, name in TERRAINS.items()}
    noises = {name: learned_noise(group, RULES[THESIS]) for name, group in groups.items()}
    fractions: dict[str, dict[str, Floats]] = {}
    panels: dict[str, list[Panel]] = {}
    for key, _, _, _, rules in KINDS:
        for name, group in groups.items():
            drawn = _draw(fixture, group, noises[name], rules)
            panels.setdefault(key, []).append(_panel(name, group, drawn))
            fraction = np.var(drawn.poses[:, -1], axis=0, ddof=1) / np.diag(measured_scatter(group)[-1])
            fractions.setdefault(key, {})[name] = fraction
    return [_figure(fixture, kind, tuple(panels[kind[0]]), fractions) for kind in KINDS]


def _draw(fixture: Fixture, group: SteadyGroup, learned: LearnedNoise, rules: DrawRules) -> DrawnPaths:
    twist = slipped_twist(group, np.array(fit_slip(group).slip))
    return draw_paths(twist, learned.noise, seed=fixture.seed, rules=rules)


def _panel(name: str, group: SteadyGroup, drawn: DrawnPaths) -> Panel:
    curve = slip_path(group, np.array(fit_slip(group).slip), drawn.times)
    ends = drawn.poses[:, -1, :2]
    lines = (
        paths_line(list(drawn.poses), label="drawn"),
        curve_line(curve, "learned slip", FITTED),
        outline(
            curve[-1, :2], measured_scatter(group)[-1][:2, :2], label="measured ends, 1 sigma", colour=INK
        ),
        outline(ends.mean(axis=0), np.cov(ends.T), label="drawn ends, 1 sigma", colour=BASELINE),
    )
    return Panel(f"{name}: {len(drawn.poses)} drawn", "x, forward [m]", "y, left [m]", lines)


def _text(fractions: dict[str, Floats]) -> str:
    """Say the fractions of the measured variance at the end, per terrain."""
    return "; ".join(
        f"{' / '.join(f'{100 * value:.0f}' for value in fraction)} % on {name}"
        for name, fraction in fractions.items()
    )


def _figure(
    fixture: Fixture,
    kind: tuple[str, str, str, str, DrawRules],
    panels: tuple[Panel, ...],
    fractions: dict[str, dict[str, Floats]],
) -> ThesisFigure:
    key, number, title, what, _ = kind
    agrees = {
        "4-4": "New segments look like the measured ones, smoother by the noise of single poses. Their "
        f"variances at the end in x / y / θ are {_text(fractions['4-4'])} of the measured.",
        "4-5": "A start that is off in heading fans the segments out: the spread across the path grows "
        f"with the distance, that along it and in heading stays. It is {_text(fractions['4-5'])} of the "
        "measured variances at the end in x / y / θ.",
        "4-6": "Slip noise alone starts from a point and spreads in all directions, most in the distance "
        f"and heading. It is {_text(fractions['4-6'])} of the measured variances at the end in x / y / θ.",
    }[key]
    return ThesisFigure(
        key=f"figure-{key}",
        thesis=f"Figure {number}",
        title=title,
        shows=f"{COUNT} segments drawn with {what} of figure 4.3 by (4.13), around the learned slip; the "
        "1-sigma ellipses of their ends and of the measured ends.",
        agrees=agrees,
        differs="The thesis shows no measured spread beside the drawn one. Here the start's part is the "
        "known noise of the first pose, to which segments are moved, and the process noise is the "
        "disturbance of the commands; on the thesis's gravel the terrain is in it too. Slip rates are drawn "
        "again every 0.05 s and integrated exactly.",
        source=circle_source(fixture),
        parts=panels,
    )
