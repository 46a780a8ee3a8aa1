# SPDX-License-Identifier: Apache-2.0
"""How often a fleet without an odd robot alarms, and which differences it finds: `fleet_odd.py [FLEETS]`."""

from __future__ import annotations

import sys

import numpy as np

from slipwise.fleet.findings import discoveries
from slipwise.fleet.odd import Estimates, odd_ones

PARAMETERS = 12
CORRELATED = 0.4  # the errors of a robot's parameters
BETWEEN = ((0.0, 12), (1.0, 12), (10.0, 12), (10.0, 2), (3.0, 2))  # how much robots differ, in how many
OFF = (5.0, 8.0, 15.0)  # standard deviations of a robot's value


def alarms_of(
    random: np.random.Generator, robots: int, between: float, differ: int, off: float
) -> np.ndarray:
    """Return which of [parameters, robots] alarm; the last robot is off in the first parameter."""
    own = CORRELATED * np.ones((PARAMETERS, PARAMETERS)) + (1.0 - CORRELATED) * np.eye(PARAMETERS)
    std = random.lognormal(0.0, 0.3, (PARAMETERS, robots))
    value = std * (np.linalg.cholesky(own) @ random.standard_normal((PARAMETERS, robots)))
    value[:differ] += between * random.standard_normal((differ, robots))
    value[0, -1] += off
    found = odd_ones([Estimates(value[k], std[k], np.ones(robots)) for k in range(PARAMETERS)])
    chances = [found[k][place].chance for k in range(PARAMETERS) for place in range(robots)]
    return np.reshape(discoveries(chances), (PARAMETERS, robots))


def main() -> None:
    """Print a row per size of the fleet."""
    fleets = int(sys.argv[1]) if len(sys.argv) > 1 else 150
    random = np.random.default_rng(3)
    for robots in (4, 6, 12):
        false = [
            np.mean([alarms_of(random, robots, size, many, 0.0).any() for _ in range(fleets)])
            for size, many in BETWEEN
        ]
        found = [
            np.mean([alarms_of(random, robots, 0.0, 0, off)[0, -1] for _ in range(fleets)]) for off in OFF
        ]
        print(
            f"{robots} robots: false {', '.join(f'{x:.3f}' for x in false)};"
            f" found {', '.join(f'{x:.2f}' for x in found)}"
        )


if __name__ == "__main__":
    main()
