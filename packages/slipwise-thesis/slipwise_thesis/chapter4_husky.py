# SPDX-License-Identifier: Apache-2.0
"""Figures 4.2, 4.9 and 4.10 from a real Husky's 200 held commands of 6 s."""

from __future__ import annotations

import numpy as np

from slipwise.number_text import number_text
from slipwise_thesis.chapter4_fits import COLUMNS, fit_panel, fit_rows
from slipwise_thesis.chapter4_paths import held_paths
from slipwise_thesis.chapter4_rates import LABELS, NAMES
from slipwise_thesis.fixture import Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, ErrorBars, Line, Panel
from slipwise_thesis.steady import (
    GroupRules,
    PathRules,
    SlipFitRules,
    SteadyGroup,
    SteadyPath,
    compare_fits,
    fit_group_noise,
    group_paths,
    slip_table,
)
from slipwise_thesis.thesis_figure import ThesisFigure

LOG = "husky/tile_deflated_tyres"
SOURCE = f"{LOG}: a Clearpath Husky with deflated tyres on tile, 200 held commands of 6 s"
RULES = PathRules(settle=2.0)  # s: its lag is about that long
ALIKE = GroupRules(speed=0.1, curvature=0.2, yaw_rate=0.3)  # nearly every command is another one
SHOWN = 2  # groups with the most segments that drive and turn


def _paths(fixture: Fixture) -> tuple[SteadyPath, ...]:
    return held_paths(fixture.real_log(LOG), RULES)


def _groups(fixture: Fixture) -> list[SteadyGroup]:
    """Groups of at least three segments that turn."""
    groups = group_paths(_paths(fixture), ALIKE)
    return [group for group in groups if len(group) >= 3 and abs(group.omega) > 0.2]


def husky_curves(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.2 from the real log.

    Raises:
        MissingLogError: the log is not there.
    """
    groups = _groups(fixture)
    fits = [compare_fits(group) for group in groups]
    driving = sorted(
        (i for i, group in enumerate(groups) if group.curvature is not None),
        key=lambda i: -len(groups[i]),
    )[:SHOWN]
    cost = {
        name: sum(fit.curve(name).cost for fit in fits)
        for name in ("translation", "three channels", "polynomial")
    }
    apart, translation = (
        float(np.sqrt(np.mean([getattr(fit, name) ** 2 for fit in fits])))
        for name in ("to_polynomial", "translation_to_polynomial")
    )
    rows = [row for i in driving for row in fit_rows(groups[i].name, fits[i])]
    return ThesisFigure(
        key="figure-4-2-husky",
        thesis="Figure 4.2",
        title="Slip curves of a real Husky",
        shows="As figure 4.2: segments of similar commands with the best slip rates with and without "
        f"angular slip, and the polynomial; {len(driving)} of {len(groups)} groups are drawn.",
        agrees=f"Over all {len(groups)} groups that turn and have three segments or more, the cost (4.1) "
        f"with forward and side slip only is {number_text(cost['translation'] / cost['three channels'])} "
        f"times that with three degrees of freedom. The latter's paths lie {number_text(1000 * apart)} mm "
        f"rms from the polynomials, the former's {number_text(1000 * translation)} mm.",
        differs="Nearly every command of this log is another one, so a group holds commands that are "
        "alike, not the same, and its segments spread more. Polynomials have "
        f"{number_text(cost['polynomial'] / cost['three channels'])} times the cost of slip: they describe "
        "one path for all commands of a group, where slip is added to each segment's own.",
        source=SOURCE,
        parts=(
            *(fit_panel(groups[i].name, groups[i], fits[i]) for i in driving),
            Grid("Residuals of the groups drawn", ("group", *COLUMNS[1:]), tuple(rows)),
        ),
    )


def husky_rates(fixture: Fixture) -> ThesisFigure:
    """Make figures 4.9 and 4.10 from the real log.

    Raises:
        MissingLogError: the log is not there.
    """
    paths = _paths(fixture)
    noise = fit_group_noise(group_paths(paths, ALIKE)).noise
    single = [group for path in paths for group in group_paths([path])]
    rows = slip_table(single, SlipFitRules(noise=noise))
    v, omega = np.array([row.v for row in rows]), np.array([row.omega for row in rows])
    slip, bar = np.array([row.slip for row in rows]), np.array([row.bar or (0, 0, 0) for row in rows])
    panels, fraction = [], []
    for channel, (x, label) in enumerate(
        (
            (v, "commanded speed [m/s]"),
            (omega, "commanded yaw rate [rad/s]"),
            (omega, "commanded yaw rate [rad/s]"),
        )
    ):
        slope = float(x @ slip[:, channel] / (x @ x))
        fraction.append(
            (slope, 1.0 - float(np.sum((slip[:, channel] - slope * x) ** 2) / np.sum(slip[:, channel] ** 2)))
        )
        ends = np.array([x.min(), x.max()])
        dots = ErrorBars(x, slip[:, channel], bar[:, channel], "segments", FITTED)
        line = Line(ends, slope * ends, f"slope {number_text(slope)}", BASELINE, "dash", 2.0)
        panels.append(Panel(NAMES[channel].capitalize(), label, LABELS[channel], (dots, line)))
    return ThesisFigure(
        key="figure-4-9-husky",
        thesis="Figures 4.9 and 4.10",
        title="Slip rates of a real Husky",
        shows=f"Slip rates of {len(rows)} single segments by the inverse covariance, with 1-sigma bars from "
        "the scatter of similar commands, and the best lines through the origin.",
        agrees="Angular slip is linear in the yaw rate and dominant: the robot loses "
        f"{-100 * fraction[2][0]:.0f} % of the turn, and the line explains {100 * fraction[2][1]:.0f} % "
        f"of the squares. Of the forward slip rates, at most {number_text(float(np.abs(slip[:, 0]).max()))} "
        f"m/s, a line in the speed explains {100 * fraction[0][1]:.0f} %.",
        differs="Commands are spread over speeds and yaw rates, not a few circles, so each segment is a "
        "point, and the horizontal axes are the speed and the yaw rate. Side slip is no constant: it "
        f"reaches {number_text(float(np.abs(slip[:, 1]).max()))} m/s, and a line in the yaw rate, which is "
        f"a centre of turning {number_text(abs(fraction[1][0]))} m "
        f"{'behind' if fraction[1][0] > 0 else 'ahead of'} the origin of the poses, explains "
        f"{100 * fraction[1][1]:.0f} % of its squares.",
        source=SOURCE,
        parts=tuple(panels),
    )
