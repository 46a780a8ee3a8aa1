# SPDX-License-Identifier: Apache-2.0
"""A simulated robot to learn from: physics, a terrain with known slip, and drives that excite it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from slipwise.lazy_names import lazy_names

if TYPE_CHECKING:
    from slipwise_sim.drive import DRIVES, dull_drive, hold, steps_drive, thesis_drive
    from slipwise_sim.land_tamer import LandTamer
    from slipwise_sim.live_robot import LiveRobot, LiveState
    from slipwise_sim.perturbation import Perturbation
    from slipwise_sim.physics import TerrainChange, World
    from slipwise_sim.scenario import Scenario, Simulation, simulate
    from slipwise_sim.traction_law import TractionLaw, traction_force
    from slipwise_sim.truth import Truth
    from slipwise_sim.tyre_law import TyreLaw, tyre_force

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

#: Where each public name lives.
_HOMES = {
    "slipwise_sim.drive": (
        "DRIVES",
        "dull_drive",
        "hold",
        "steps_drive",
        "thesis_drive",
    ),
    "slipwise_sim.land_tamer": ("LandTamer",),
    "slipwise_sim.live_robot": (
        "LiveRobot",
        "LiveState",
    ),
    "slipwise_sim.perturbation": ("Perturbation",),
    "slipwise_sim.physics": (
        "TerrainChange",
        "World",
    ),
    "slipwise_sim.scenario": (
        "Scenario",
        "Simulation",
        "simulate",
    ),
    "slipwise_sim.traction_law": (
        "TractionLaw",
        "traction_force",
    ),
    "slipwise_sim.truth": ("Truth",),
    "slipwise_sim.tyre_law": (
        "TyreLaw",
        "tyre_force",
    ),
}
__getattr__ = lazy_names(__name__, _HOMES)
