# SPDX-License-Identifier: Apache-2.0
"""Chooses what carries ROS messages: what was asked for, or the first that can be imported."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from slipwise.errors import SettingsError
from slipwise.live.wires.wire import RosWire, WireOptions

# Name, what has to be importable, where the wire is, how to get what it needs. The first one wins.
_WIRES = (
    ("rclpy", "rclpy", "rclpy_wire:RclpyWire", "source ROS 2's setup.bash in the shell that starts slipwise"),
    ("cyclonedds", "cyclonedds", "cyclone_wire:CycloneWire", "pip install 'cyclonedds>=11'"),
)

#: What may be asked for.
WIRE_NAMES = tuple(name for name, *_ in _WIRES)


def wires_at_hand() -> list[str]:
    """Return the wires whose packages are installed, best first."""
    return [name for name, package, *_ in _WIRES if find_spec(package) is not None]


def make_wire(name: str | None, options: WireOptions) -> RosWire:
    """Open a wire.

    Args:
        name: one of `WIRE_NAMES`; None: the first whose package is installed.
        options: how the node joins the graph.

    Raises:
        SettingsError: there is no such wire, its package is missing or broken, or it does not start.
    """
    if name is not None and name not in WIRE_NAMES:
        raise SettingsError(f'there is no transport "{name}"', advice=f"ROS comes by {', '.join(WIRE_NAMES)}")
    at_hand = wires_at_hand()
    if name is None and not at_hand:
        ways = "; ".join(way for *_, way in _WIRES)
        raise SettingsError("no ROS transport is installed", advice=f"one of: {ways}")
    chosen = name or at_hand[0]
    place, way = next((place, way) for known, _, place, way in _WIRES if known == chosen)
    if chosen not in at_hand:
        raise SettingsError(f"{chosen} is not installed", advice=way)
    module, _, kind = place.partition(":")
    try:
        made: RosWire = getattr(import_module(f"slipwise.live.wires.{module}"), kind)(options)
    except ImportError as error:
        raise SettingsError(f"{chosen} cannot be imported: {error}", advice=way) from error
    return made
