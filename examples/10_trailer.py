# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
"""A robot tows a trailer: hitch angle, hitch offset, trailer length and slip are learned from one drive."""

# The hitch angle is a state beside the pose: the trailer's direction minus the robot's. Its wheels do not
# move sideways: that turns it. A towed trailer straightens, a pushed one folds, so the drive goes ahead.

# %%
from __future__ import annotations

import numpy as np

from slipwise.dynamics import Dynamics, Parameter, State, learn_dynamics

PERIOD, HOLD, FINE = 0.1, 2.5, 5  # s between samples, s that a command is held, steps of the truth a sample
TRUTH = {"offset": 0.35, "length": 1.20, "speed_slip": -0.06, "turn_slip": -0.25}
POSE_STD, HITCH_STD = (0.02, 0.02, 0.01), 0.02  # m, m, rad; rad
SWAY = (0.03, 0.03, 0.03, 0.03)  # of what adds to each rate, m or rad per square root of a second


def rates(state, inputs, parameters):
    """The robot moves with its slip; the hitch moves ahead with it and sideways by offset times yaw rate."""
    _, _, yaw, hitch = state
    offset, length, speed_slip, turn_slip = parameters
    v, w = (1.0 + speed_slip) * inputs[0], (1.0 + turn_slip) * inputs[1]
    trailer = -(v * np.sin(hitch) + offset * w * np.cos(hitch)) / length
    return v * np.cos(yaw), v * np.sin(yaw), w, trailer - w


TRAILER = Dynamics(
    states=(
        State("x", "m", measured=POSE_STD[0], noise=SWAY[0]),
        State("y", "m", measured=POSE_STD[1], noise=SWAY[1]),
        State("yaw", "rad", measured=POSE_STD[2], angle=True, noise=SWAY[2]),
        State("hitch", "rad", measured=HITCH_STD, angle=True, noise=SWAY[3]),
    ),
    inputs=("v", "w"),
    parameters=(
        Parameter("offset", 0.2, 0.3, "m"),  # from the robot's axle back to the hitch
        Parameter("length", 1.5, 0.5, "m"),  # from the hitch back to the trailer's axle
        Parameter("speed_slip", 0.0, 0.2),
        Parameter("turn_slip", 0.0, 0.3),
    ),
    rates=rates,
)


def towed_drive(seed: int, seconds: float = 120.0, correlated: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return commands (t, v, w) and measurements (t, x, y, yaw, hitch); noise lasts `correlated` s."""
    rng, count = np.random.default_rng(seed), int(seconds / PERIOD)
    hold = int(HOLD / PERIOD)
    drawn = rng.uniform((0.3, -0.7), (1.2, 0.7), (count // hold + 1, 2))
    held, step = np.repeat(drawn, hold, axis=0)[:count], PERIOD / FINE
    fades = np.exp(-step / correlated) if correlated else 0.0  # of both noises, over one step
    pushed, error, state, seen = np.zeros(4), np.zeros(4), np.zeros(4), []
    for k in range(count * FINE):
        error = fades * error + np.sqrt(1.0 - fades**2) * rng.normal(size=4)
        if k % FINE == 0:
            seen.append(state + error * (*POSE_STD, HITCH_STD))
        pushed = fades * pushed + (1.0 - fades) * rng.normal(
            size=4
        )  # in the long run as strong as white noise
        moved = np.array(rates(state, held[k // FINE], tuple(TRUTH.values())))
        state = state + step * moved + np.sqrt(step) * pushed * SWAY
    t = PERIOD * np.arange(count)
    return np.column_stack((t, held)), np.column_stack((t, seen))


# %%
towed, pushed = (rates((0.0, 0.0, 0.0, 0.2), (v, 0.0), tuple(TRUTH.values()))[3] for v in (1.0, -1.0))
assert towed < 0.0 < pushed  # what is towed straightens, what is pushed folds

if __name__ == "__main__":
    learned = learn_dynamics(TRAILER, *towed_drive(seed=1))
    print(learned)
    for name, truth in TRUTH.items():
        assert abs(learned[name].value - truth) < 3.0 * learned[name].std, name
    ahead = learned.predict([[0.0, 0.8, 0.5]], [1.0, 3.0])  # a bend to the left
    print(f"hitch in 3 s: {np.degrees(ahead.states[-1][3]):.0f} deg")
