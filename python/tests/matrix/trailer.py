# SPDX-License-Identifier: Apache-2.0
"""The use of a trailer's angle: its hitch and length are learned as dynamics of the user's own."""

from __future__ import annotations

import numpy as np
from matrix.learned import Learned
from matrix.situations import HELD, HITCH, SLIP

from slipwise.dynamics import Dynamics, Parameter, State, learn_dynamics, load_dynamics

NAMES = ("offset", "length", "speed_slip", "turn_slip")
SIGMAS = 4.0


def rates(state, inputs, parameters):  # type: ignore[no-untyped-def] # as a user writes them
    """Return the rates of x, y, yaw and the angle between the robot and its trailer."""
    _, _, yaw, hitch = state
    offset, length, speed_slip, turn_slip = parameters
    v, w = (1.0 + speed_slip) * inputs[0], (1.0 + turn_slip) * inputs[1]
    pulled = (v * np.sin(hitch) + offset * w * np.cos(hitch)) / length
    return v * np.cos(yaw), v * np.sin(yaw), w, -pulled - w


TRAILER = Dynamics(
    states=(
        State("x", "m", measured=0.005, noise=0.01),
        State("y", "m", measured=0.005, noise=0.01),
        State("yaw", "rad", measured=0.003, angle=True, noise=0.01),
        State("hitch", "rad", measured=0.01, angle=True, noise=0.01),
    ),
    inputs=("v", "w"),
    parameters=tuple(
        Parameter(name, value, std)
        for name, value, std in zip(NAMES, (0.1, 1.5, 0, 0), (0.3, 0.5, 0.2, 0.3), strict=True)
    ),
    rates=rates,
)


def dynamics(learned: Learned) -> None:
    """Hitch, length and slip are learned within their covariance, and are the same from the saved file."""
    table = np.genfromtxt(learned.log, delimiter=",", names=True)
    drive, seen = np.isfinite(table["odo_v"]), np.isfinite(table["hitch"])
    inputs = np.column_stack([table[name][drive] for name in ("t", "odo_v", "odo_omega")])
    inputs[:, 0] -= HELD  # learning holds them from their stamp on
    measured = np.column_stack([table[name][seen] for name in ("t", "x", "y", "yaw", "hitch")])
    found = learn_dynamics(TRAILER, inputs, measured)
    for name, truth in zip(NAMES, (*HITCH, *SLIP.values()), strict=True):
        off = abs(found[name].value - truth) / found[name].std
        assert off < SIGMAS, f"{name} is {found[name].value:.3f}, {off:.1f} standard deviations off {truth:g}"
    path = found.save(learned.folder / "trailer.yaml")
    kept = load_dynamics(path, TRAILER)
    assert np.allclose([p.value for p in kept.parameters], [p.value for p in found.parameters])
