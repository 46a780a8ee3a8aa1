# SPDX-License-Identifier: Apache-2.0
"""Speed limits and sizes of some vehicles, each with its source."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

from slipwise.errors import SettingsError
from slipwise.excitation.command_space import CommandSpace


@dataclass(frozen=True)
class Vehicle:
    """What a drive has to know of a robot before anything is learned."""

    space: CommandSpace
    radius: float  # m, of a disc about base_link that covers it
    source: str


_ROBOTIS = "ROBOTIS e-Manual, TurtleBot3 specifications, and turtlebot3_description for where the body sits"
_CLEARPATH = "clearpath_common, clearpath_control/config/{}/control.yaml, and the maker's length and width"

VEHICLES: MappingProxyType[str, Vehicle] = MappingProxyType(
    {
        "husky": Vehicle(CommandSpace(1.0, 1.0), 0.60, _CLEARPATH.format("a200")),
        "jackal": Vehicle(CommandSpace(2.0, 4.0), 0.34, _CLEARPATH.format("j100")),
        "warthog": Vehicle(CommandSpace(5.0, 4.0), 1.03, _CLEARPATH.format("w200")),
        "turtlebot3-burger": Vehicle(CommandSpace(0.22, 2.84), 0.14, _ROBOTIS),
        "turtlebot3-waffle": Vehicle(CommandSpace(0.26, 1.82), 0.26, _ROBOTIS),
        "turtlebot4": Vehicle(CommandSpace(0.31, 1.90), 0.18, "TurtleBot 4 User Manual, hardware, safe mode"),
        "land-tamer": Vehicle(CommandSpace(2.0, 1.0), 1.50, "slipwise simulate: its vehicle and its drives"),
    }
)


def vehicle_named(name: str) -> Vehicle:
    """Return a vehicle.

    Raises:
        SettingsError: it is not known here.
    """
    if name not in VEHICLES:
        raise SettingsError(
            f"unknown vehicle {name!r}",
            where="vehicle",
            advice=f"known are {', '.join(VEHICLES)}; or give its limits: speed, yaw rate and radius",
        )
    return VEHICLES[name]
