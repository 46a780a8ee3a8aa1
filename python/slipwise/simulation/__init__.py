# SPDX-License-Identifier: Apache-2.0
"""A simulated robot to learn from: physics, a terrain with known slip, and drives that excite it."""

from slipwise.simulation.drive import DRIVES, dull_drive, hold, steps_drive, thesis_drive
from slipwise.simulation.land_tamer import LandTamer
from slipwise.simulation.live_robot import LiveRobot, LiveState
from slipwise.simulation.perturbation import Perturbation
from slipwise.simulation.physics import TerrainChange, World
from slipwise.simulation.simulate import Scenario, Simulation, simulate
from slipwise.simulation.traction_law import TractionLaw, traction_force
from slipwise.simulation.truth import Truth
from slipwise.simulation.tyre_force import TyreLaw, tyre_force

__all__ = [
    "DRIVES",
    "LandTamer",
    "LiveRobot",
    "LiveState",
    "Perturbation",
    "Scenario",
    "Simulation",
    "TerrainChange",
    "TractionLaw",
    "Truth",
    "TyreLaw",
    "World",
    "dull_drive",
    "hold",
    "simulate",
    "steps_drive",
    "thesis_drive",
    "traction_force",
    "tyre_force",
]
