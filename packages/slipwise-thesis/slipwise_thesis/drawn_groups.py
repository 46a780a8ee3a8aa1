# SPDX-License-Identifier: Apache-2.0
"""Groups of path segments whose slip, slip noise and P0 are known, because they are drawn from these."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise_thesis import _thesis
from slipwise_thesis.fixture import CIRCLE
from slipwise_thesis.steady import DrawRules, SteadyGroup, SteadyPath, draw_paths, group_paths

SLIP = np.array([-0.02, 0.01, -0.08])  # [m/s, m/s, rad/s]
PSD = np.array([4e-4, 2e-4, 3e-4])  # [m^2/s, m^2/s, rad^2/s]
START = np.array([1e-4, 1e-4, 4e-4])  # [m^2, m^2, rad^2]
NOISE = _thesis.SteadyNoise(PSD, START, np.zeros(3))


def drawn_group(*, seed: int, count: int) -> SteadyGroup:
    """Return segments of 3 s under the command of figure 4.1."""
    v, omega = CIRCLE[0], CIRCLE[0] * CIRCLE[1]
    twist = _core.BodyTwist(v + SLIP[0], SLIP[1], omega + SLIP[2])
    drawn = draw_paths(twist, NOISE, seed=seed, rules=DrawRules(count=count, period=0.1))
    # The first pose of a measured segment is the origin: what it is off by is in all later poses.
    poses = np.concatenate((np.zeros((count, 1, 3)), drawn.poses[:, 1:]), axis=1)
    paths = [SteadyPath("drawn", 0.0, (v, 0.0, omega), drawn.times, path) for path in poses]
    (group,) = group_paths(paths)
    return group
