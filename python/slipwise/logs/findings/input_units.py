# SPDX-License-Identifier: Apache-2.0
"""Which unit the speeds of inputs may be in, by how far poses move and turn for them."""

from __future__ import annotations

import math

from slipwise.number_text import list_text

_WHEEL = {  # radians per second in a wheel's unit
    "rad/s": 1.0,
    "rev/s": 2.0 * math.pi,
    "rev/min": math.pi / 30.0,
    "rad/min": 1.0 / 60.0,
    "deg/s": math.pi / 180.0,
}
_RADIUS = (0.03, 0.6)  # m, of wheels of ground robots
_SPEED = {"mm/s": 0.001, "cm/s": 0.01, "km/h": 1.0 / 3.6, "ft/s": 0.3048}
_COMMANDED = {"km/h": 1.0 / 3.6, "miles per hour": 0.44704}  # a drive of such a gain works all the same
_SAME = (0.92, 1.03)  # of the unit; drives that do what they are asked do so much
_TURN = {name: size for name, size in _WHEEL.items() if name != "rad/s"} | {"mrad/s": 0.001}
_SLIP = (0.85, 1.05)  # how far a robot moves for what its wheels say, ordinarily
_TURN_SLIP = (0.35, 1.1)  # the same of turns


def likely_speeds(scale: float) -> str:
    """Say which units would make poses move `scale` times as far as inputs say; empty where none would."""
    plain = [f"in {name}" for name, size in _SPEED.items() if _within(scale / size, _SLIP)]
    wheels = [
        f"in {name} of wheels of {scale / size:.2g} m"
        for name, size in _WHEEL.items()
        if _within(scale / size, _RADIUS)
    ]
    return list_text([*plain, *wheels], "or")


def likely_commands(scale: float) -> tuple[str, float] | None:
    """Return a unit, and its factor, of which poses would move `scale` of what commands say; None of none."""
    return next((each for each in _COMMANDED.items() if _within(scale / each[1], _SAME)), None)


def likely_turns(scale: float) -> tuple[str, float]:
    """Say in which units poses would turn `scale` times as much as inputs say, and the first factor."""
    found = {name: size for name, size in _TURN.items() if _within(scale / size, _TURN_SLIP)}
    said = list_text([f"in {name} (times {size:.4g})" for name, size in found.items()], "or")
    return said, next(iter(found.values()), scale)


def _within(value: float, span: tuple[float, float]) -> bool:
    return span[0] <= value <= span[1]
