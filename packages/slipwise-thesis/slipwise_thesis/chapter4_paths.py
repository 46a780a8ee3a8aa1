# SPDX-License-Identifier: Apache-2.0
"""Figure 4.1: path segments of one held command, moved to the origin."""

from __future__ import annotations

import numpy as np

from slipwise.logs import Log
from slipwise.number_text import number_text
from slipwise_thesis.fixture import CIRCLE, DISTURBANCE, STD_XY, STD_YAW, Fixture
from slipwise_thesis.panel import FITTED, IDEAL, Dash, Floats, Line, Panel, paths_line
from slipwise_thesis.steady import PathRules, SteadyGroup, SteadyPath, compare_fits, cut_paths, group_paths
from slipwise_thesis.thesis_figure import ThesisFigure

SETTLE = 3.0  # [s] left out after a change of command: nearly four of the drive's time constants
RULES = PathRules(length=3.0, least_distance=0.0, settle=SETTLE)
TERRAINS = {"tyre-force": "tyre-force terrain", "contact-friction": "contact-friction terrain"}


def held_paths(log: Log, rules: PathRules = RULES) -> tuple[SteadyPath, ...]:
    """Return the path segments of all runs of a log, under their commands."""
    runs = [(run, run.commands) for run in log.runs if run.commands is not None]
    return tuple(path for run, commands in runs for path in cut_paths(run, commands, rules).paths)


def circle_group(fixture: Fixture, terrain: str = "tyre-force") -> SteadyGroup:
    """Return the segments of the command of figure 4.1."""
    (group,) = group_paths(held_paths(fixture.one_circle(terrain).log))
    return group


def circle_source(fixture: Fixture) -> str:
    """Say what `circle_group` is cut from."""
    v, curvature = CIRCLE
    return (
        f"simulated Land Tamer (MuJoCo), {v:g} m/s and {curvature:g} 1/m held for "
        f"{fixture.size.one_circle_time:g} s on each terrain; the command is disturbed by "
        f"{DISTURBANCE[0]:g} m/s and {DISTURBANCE[1]:g} rad/s, drawn again every 0.05 s; poses at 20 Hz with "
        f"{STD_XY:g} m and {STD_YAW:g} rad of noise"
    )


def curve_line(path: Floats, label: str, colour: str, dash: Dash = "dash") -> Line:
    """Return a fitted curve [K, 3] as a line that stands out from the segments."""
    return Line(path[:, 0], path[:, 1], label, colour, dash, 2.4)


def collected_paths(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.1."""
    panels, sentences = [], []
    for terrain, name in TERRAINS.items():
        group = circle_group(fixture, terrain)
        fits = compare_fits(group)
        ideal, polynomial = fits.curve("no slip"), fits.curve("polynomial")
        lines = (
            paths_line([path.poses for path in group.paths], label="measured"),
            curve_line(ideal.path, "no slip", IDEAL),
            curve_line(polynomial.path, "second-order polynomial", FITTED),
        )
        title = f"{name}: {len(group)} segments of 3 s"
        panels.append(Panel(title, "x, forward [m]", "y, left [m]", lines, equal_axes=True))
        turned = float(np.mean([path.poses[-1, 2] for path in group.paths]))
        sentences.append(
            f"on {name} the segments turn by {number_text(turned)} rad where the command asks for "
            f"{number_text(group.omega * float(fits.times[-1]))} rad, and end "
            f"{number_text(float(np.hypot(*(ideal.path[-1] - polynomial.path[-1])[:2])))} m from where it "
            f"leads; the polynomial leaves {number_text(polynomial.rms_position)} m rms"
        )
    return ThesisFigure(
        key="figure-4-1",
        thesis="Figure 4.1",
        title="Collected path segments",
        shows="Segments of one held command, each moved to the origin; the path that the command alone would "
        "give; the best polynomial of second order in time.",
        agrees="The segments bundle around a curve that the command misses to the outside: "
        f"{'; '.join(sentences)}. The polynomial fits, and tells nothing of slip.",
        differs="The terrains are even and the same everywhere, so the bundle is as wide as the disturbance "
        "of the commands and the noise of the first pose make it. The thesis's loose gravel adds its own, "
        "and its poses were smoothed by an inertial unit, so that its single segments look smoother.",
        source=circle_source(fixture),
        parts=tuple(panels),
    )
