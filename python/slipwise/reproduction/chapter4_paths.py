# SPDX-License-Identifier: Apache-2.0
"""Figure 4.1: path segments of one held command, moved to the origin."""

from __future__ import annotations

import numpy as np

from slipwise.logs import Log
from slipwise.number_text import number_text
from slipwise.reproduction.bench import CIRCLE, Bench
from slipwise.reproduction.exhibit import Exhibit
from slipwise.reproduction.panel import FITTED, IDEAL, Dash, Floats, Line, Panel, paths_line
from slipwise.steady import PathRules, SteadyGroup, SteadyPath, compare_fits, cut_paths, group_paths

SETTLE = 3.0  # [s] left out after a change of command: nearly four of the drive's time constants
RULES = PathRules(length=3.0, least_distance=0.0, settle=SETTLE)


def held_paths(log: Log, rules: PathRules = RULES) -> tuple[SteadyPath, ...]:
    """Return the path segments of all runs of a log, under their commands."""
    return tuple(
        path
        for run in log.runs
        if run.commands is not None
        for path in cut_paths(run, run.commands, rules).paths
    )


def circle_group(bench: Bench, ground: str = "tyre-force") -> SteadyGroup:
    """Return the segments of the command of figure 4.1."""
    (group,) = group_paths(held_paths(bench.one_circle(ground).log))
    return group


def curve_line(path: Floats, label: str, colour: str, dash: Dash = "dash") -> Line:
    """Return a fitted curve [K, 3] as a line that stands out from the segments."""
    return Line(path[:, 0], path[:, 1], label, colour, dash, 2.4)


def collected_paths(bench: Bench) -> Exhibit:
    """Make figure 4.1."""
    group = circle_group(bench)
    fits = compare_fits(group)
    ideal, polynomial = fits.curve("no slip"), fits.curve("polynomial")
    ends = np.array([path.poses[-1] for path in group.paths])
    turned, told = float(np.mean(ends[:, 2])), group.omega * float(fits.times[-1])
    v, curvature = CIRCLE
    panel = Panel(
        f"{len(group)} segments of 3 s at {v:g} m/s and {curvature:g} 1/m",
        "x, forward [m]",
        "y, left [m]",
        (
            paths_line([path.poses for path in group.paths], label="measured"),
            curve_line(ideal.path, "no slip", IDEAL),
            curve_line(polynomial.path, "second-order polynomial", FITTED),
        ),
        equal_axes=True,
    )
    return Exhibit(
        key="figure-4-1",
        thesis="Figure 4.1",
        title="Collected path segments",
        shows="Segments of one held command, moved to the origin, with the path that the command alone "
        "would give and the best second-order polynomial in time.",
        agrees="The segments bundle around one curve that the command misses: they turn by "
        f"{number_text(turned)} rad where the command asks for {number_text(told)} rad. The polynomial fits "
        f"with {number_text(polynomial.rms_position)} m rms, and tells nothing of slip.",
        differs="The ground is simulated and even, so the bundle is as wide as the wandering of the drive "
        "and the noise of the poses make it; the thesis's loose gravel adds its own.",
        source=f"simulated Land Tamer on tyre-force ground, one command for {bench.size.one_circle_time:g} s",
        parts=(panel,),
    )
