# SPDX-License-Identifier: Apache-2.0
"""A cart with drag, simulated, for the tests of a user's dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.dynamics import Dynamics, Parameter, State

Floats = NDArray[np.float64]

PERIOD = 0.1  # s
MEASURED = 0.02  # m


def cart_rates(state: Any, inputs: Any, parameters: Any) -> Any:
    """Rates of place and speed under a force."""
    (_, speed), (force,), (drag, gain) = state, inputs, parameters
    return speed, gain * force - drag * speed


CART = Dynamics(
    states=(State("place", "m", measured=MEASURED), State("speed", "m/s", noise=0.1, start_std=0.3)),
    inputs=("force",),
    parameters=(Parameter("drag", 0.8, 0.2, "1/s"), Parameter("gain", 1.0, 0.3)),
    rates=cart_rates,
)


@dataclass(frozen=True)
class Ride:
    """A simulated ride and its truth."""

    inputs: Floats
    measurements: Floats
    truth: tuple[float, float]  # drag, gain


def ride(seed: int, *, seconds: float = 40.0, colour: float = 0.0, force: float = 1.0) -> Ride:
    """Simulate a ride with parameters from the prior; `colour` is the time of its noise [s], 0 if white."""
    rng = np.random.Generator(np.random.PCG64(seed))
    truth = tuple((p.value + p.std * rng.normal()) for p in CART.parameters)
    count, fine = int(seconds / PERIOD), 10
    t = np.arange(count) * PERIOD
    pushed = force * (np.sin(1.3 * t) + np.where(t % 8.0 < 4.0, 1.0, -1.0))
    keep = np.exp(-PERIOD / colour) if colour > 0.0 else 0.0
    state, error, seen = np.zeros(2), 0.0, []
    for each in pushed.tolist():
        error = keep * error + np.sqrt(1.0 - keep**2) * MEASURED * rng.normal()
        seen.append(state[0] + error)
        for _ in range(fine):
            h = PERIOD / fine
            middle = state + 0.5 * h * np.array(cart_rates(state, (each,), truth))
            state = state + h * np.array(cart_rates(middle, (each,), truth))
            state[1] += 0.1 * np.sqrt(h) * rng.normal()
    return Ride(np.column_stack((t, pushed)), np.column_stack((t, seen)), (truth[0], truth[1]))
