# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""Learn a boat: drag, thrust and current of a differential-thrust boat from its poses, by its own equations.

Nothing of it is about wheels: the same filter learns whatever has a state and a rate of change.
"""

# %%
from __future__ import annotations

import numpy as np

from slipwise.dynamics import Dynamics, Parameter, State, learn_dynamics

PERIOD, SECONDS = 0.1, 240.0  # s
TRUTH = (0.9, 1.6, 0.35, 1.2, 0.8, 0.15, -0.1)  # of the parameters below, in their order


def rates(state, inputs, parameters):
    """Poses move with the water; thrusts of both sides push and turn, drag grows with the square of speed."""
    _, _, yaw, u, v, r = state  # u ahead, v to the left [m/s], r [rad/s], through the water
    left, right = inputs  # -1 to 1
    thrust, turn, drag, side_drag, turn_drag, east, north = parameters
    return (
        u * np.cos(yaw) - v * np.sin(yaw) + east,
        u * np.sin(yaw) + v * np.cos(yaw) + north,
        r,
        0.5 * thrust * (left + right) - drag * u * np.abs(u) + v * r,
        -side_drag * v - u * r,
        turn * (right - left) - turn_drag * r,
    )


BOAT = Dynamics(
    states=(
        State("x", "m", measured=0.05),
        State("y", "m", measured=0.05),
        State("yaw", "rad", measured=0.02, angle=True),
        State("u", "m/s", noise=0.03, start_std=0.5),
        State("v", "m/s", noise=0.03, start_std=0.2),
        State("r", "rad/s", noise=0.03, start_std=0.2),
    ),
    inputs=("left", "right"),
    parameters=(
        Parameter("thrust", 0.6, 0.5, "m/s^2"),
        Parameter("turn", 1.0, 1.0, "rad/s^2"),
        Parameter("drag", 0.5, 0.4, "1/m"),
        Parameter("side_drag", 0.8, 0.8, "1/s"),
        Parameter("turn_drag", 1.2, 0.8, "1/s"),
        Parameter("east", 0.0, 0.3, "m/s"),
        Parameter("north", 0.0, 0.3, "m/s"),
    ),
    rates=rates,
)


def simulated_drive(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return thrusts (t, left, right) held for some seconds each, and noisy poses (t, x, y, yaw)."""
    rng, truth = np.random.Generator(np.random.PCG64(seed)), TRUTH
    count = int(SECONDS / PERIOD)
    held = np.repeat(rng.uniform(-0.2, 1.0, (count // 30 + 1, 2)), 30, axis=0)[:count]
    state, poses, fine = np.zeros(6), [], 10
    for thrusts in held:
        poses.append(state[:3] + rng.normal(0.0, (0.05, 0.05, 0.02)))
        for _ in range(fine):
            h = PERIOD / fine
            middle = state + 0.5 * h * np.array(rates(state, thrusts, truth))
            state = state + h * np.array(rates(middle, thrusts, truth))
            state[3:] += 0.03 * np.sqrt(h) * rng.normal(size=3)
    t = np.arange(count) * PERIOD
    return np.column_stack((t, held)), np.column_stack((t, poses))


# %%
assert rates((0.0, 0.0, 0.0, 1.0, 0.0, 0.0), (0.0, 0.0), TRUTH)[3] < 0.0  # without thrust it slows down

if __name__ == "__main__":
    learned = learn_dynamics(BOAT, *simulated_drive())
    print(learned)
    for parameter, truth in zip(learned.parameters, TRUTH, strict=True):
        assert parameter.identified, parameter.name
        assert abs(parameter.value - truth) < 3.0 * parameter.std, parameter.name
    assert learned.scores[-1].ratio < 0.2  # of the error after 5 s to that of the values given
    assert learned.scores[-1].nis < 2.0
    ahead = learned.predict([[0.0, 1.0, 0.2]], [1.0, 2.0, 5.0])  # hard to starboard
    for t, state, spread in zip(ahead.t, ahead.states, ahead.covariance, strict=True):
        std = np.sqrt(np.diag(spread))
        print(f"in {t:g} s at x {state[0]:.2f} +- {std[0]:.2f} m, y {state[1]:.2f} +- {std[1]:.2f} m")
