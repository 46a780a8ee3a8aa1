# SPDX-License-Identifier: Apache-2.0
"""The drive of thesis 6.2: nine minutes of circles at various speeds and curvatures, from commands."""

from __future__ import annotations

import itertools

import numpy as np

from slipwise.logs import Inputs, Log
from slipwise_sim import Scenario, simulate
from slipwise_thesis.fixture import CURVATURES, SPEEDS, Fixture

RATE = 20.0  # [Hz] of the commands


def circling(fixture: Fixture, terrain: str) -> Log:
    """Drive all circles in random order, each as long as the others."""
    held = [(v, side * kappa * v) for v, kappa, side in itertools.product(SPEEDS, CURVATURES, (1, -1))]
    order = np.random.Generator(np.random.PCG64([fixture.seed, 6])).permutation(len(held))
    t = np.arange(round(fixture.size.long_time * RATE)) / RATE
    place = np.minimum((t * len(held) / fixture.size.long_time).astype(np.int64), len(held) - 1)
    v, omega = np.array(held)[order[place]].T
    commands = Inputs(t=t, v=v.copy(), vy=np.zeros_like(t), omega=omega.copy())
    scenario = Scenario(duration=fixture.size.long_time, commands=commands, terrain=terrain)
    return simulate(scenario, seed=fixture.seed).log
