# SPDX-License-Identifier: Apache-2.0
"""Figures 4.7 and 4.8: the commands of the experiment, and the vehicle."""

from __future__ import annotations

import numpy as np

from slipwise_sim import LandTamer
from slipwise_thesis.chapter4_paths import RULES, held_paths
from slipwise_thesis.fixture import CURVATURES, Fixture
from slipwise_thesis.grid import Grid
from slipwise_thesis.panel import BASELINE, FITTED, INK, MEASURED, Floats, Line, Panel
from slipwise_thesis.steady import group_paths
from slipwise_thesis.thesis_figure import ThesisFigure


def commands(fixture: Fixture) -> ThesisFigure:
    """Make figure 4.7."""
    simulation = fixture.circles()
    (run,) = simulation.log.runs
    commanded = run.commands
    assert commanded is not None
    paths = held_paths(simulation.log)
    groups = group_paths(paths)
    speed = Panel("Commanded speed", "time [s]", "V [m/s]", (Line(commanded.t, commanded.v, "", FITTED),))
    curvature = Panel(
        "Commanded curvature",
        "time [s]",
        "κ [1/m]",
        (Line(commanded.t, commanded.omega / commanded.v, "", BASELINE),),
    )
    wheel_separation = Panel(
        "Where the robot went",
        "x [m]",
        "y [m]",
        (Line(simulation.truth.x, simulation.truth.y, "", MEASURED, width=0.8),),
        equal_axes=True,
    )
    return ThesisFigure(
        key="figure-4-7",
        thesis="Figure 4.7",
        title="Commands of the experiment",
        shows="Speed and curvature as they were commanded, each pair held, and the path.",
        agrees=f"Circles at {len(fixture.size.circle_speeds)} speeds and {len(CURVATURES)} curvatures, to "
        f"the left and to the right, on level terrain that is the same everywhere: {len(groups)} commands "
        f"give {len(paths)} segments of {RULES.length:g} s.",
        differs=f"Each command is held for {fixture.size.circle_time:g} s, and the first {RULES.settle:g} s "
        "are left out until the drive's lag has settled; the thesis drove for longer and does not say what "
        "it left out, nor which its speeds and other curvatures were.",
        source="simulated Land Tamer on tyre-force terrain",
        parts=(speed, curvature, wheel_separation),
    )


def vehicle() -> ThesisFigure:
    """Make figure 4.8 from the simulated vehicle's constants."""
    robot = LandTamer()
    wheels = [_box(place, (2 * robot.wheel_radius, robot.wheel_width)) for place in robot.wheel_places]
    lines = [Line(*_box(np.zeros(2), robot.hull_size[:2]), "hull", INK)]
    lines += [Line(*wheel, "wheels", FITTED) for wheel in wheels]
    rows = (
        ("mass", f"{robot.mass:g} kg"),
        ("wheels", f"{len(robot.wheel_places)}, radius {robot.wheel_radius:g} m"),
        ("wheel_separation", f"{robot.wheel_separation:g} m"),
        ("axles", ", ".join(f"{axle:g}" for axle in robot.axles) + " m"),
        ("delay of a command", f"{robot.command_delay:g} s"),
        ("time constant of a side's speed", f"{robot.command_lag:g} s"),
    )
    return ThesisFigure(
        key="figure-4-8",
        thesis="Figure 4.8",
        title="The vehicle",
        shows="The simulated vehicle from above, and its constants.",
        agrees="Six driven wheels, skid-steered, closed-loop speed control per side.",
        differs="The thesis shows a photograph and gives no delay and no time constant; its section 8.1 "
        "names both as future work. Those here were published for the Land Tamer later (Seegmiller et al. "
        "2013). The other constants are plausible for a vehicle of its kind, not its own.",
        source="slipwise_sim.LandTamer",
        parts=(
            Panel("From above", "x, forward [m]", "y, left [m]", tuple(lines), equal_axes=True),
            Grid("Constants", ("constant", "value"), rows),
        ),
    )


def _box(centre: Floats, size: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Return the outline of a rectangle, x [5] and y [5]."""
    x, y = np.array([1, -1, -1, 1, 1]) * size[0] / 2, np.array([1, 1, -1, -1, 1]) * size[1] / 2
    return centre[0] + x, centre[1] + y
