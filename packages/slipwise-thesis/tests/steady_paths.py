# SPDX-License-Identifier: Apache-2.0
"""Groups of path segments with known slip and noise, drawn by the package itself."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise_thesis import _thesis
from slipwise_thesis.steady import DrawRules, GroupRules, SteadyGroup, SteadyPath, draw_paths, group_paths

SLIP = np.array([-0.02, 0.01, -0.08])
PSD = np.array([4e-4, 2e-4, 3e-4])
START = np.array([1e-4, 1e-4, 4e-4])
NOISE = _thesis.SteadyNoise(PSD, START, np.zeros(3))
QUIET = _thesis.SteadyNoise(PSD * 1e-3, START * 1e-3, np.zeros(3))


def drawn_group(
    *,
    seed: int,
    count: int = 60,
    command: tuple[float, float] = (0.5, 0.25),
    noise: _thesis.SteadyNoise = NOISE,
) -> SteadyGroup:
    """Return `count` segments of 3 s under one command (v, omega) with the slip and noise above."""
    v, omega = command
    twist = _core.BodyTwist(v + SLIP[0], SLIP[1], omega + SLIP[2])
    drawn = draw_paths(twist, noise, seed=seed, rules=DrawRules(count=count, period=0.1))
    paths = [
        SteadyPath("drawn", 0.0, (v, 0.0, omega), drawn.times, np.vstack((np.zeros((1, 3)), poses[1:])))
        for poses in drawn.poses
    ]
    (group,) = group_paths(paths, GroupRules())
    return group
