# SPDX-License-Identifier: Apache-2.0
"""A fleet of simulated robots of one type, whose slip is drawn about what they have in common."""

from __future__ import annotations

from functools import cache

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration.from_prior import calibrate_from
from slipwise.calibration.log_knowledge import LogKnowledge
from slipwise.logs import Log

BASIS = _core.named_basis("edd-2")
MEAN, SPREAD = np.array([-0.15, -0.35]), np.array([0.02, 0.03])  # of the robots
GENTLE = {"speeds": (0.4, 1.6), "yaw_rates": (-0.3, 0.3), "hold": (40, 200)}
NOISY = {"pose_std": (0.05, 0.03), "slip_psd": (1e-3, 1e-3, 1e-3)}


def robot_slip(seed: int) -> tuple[float, ...]:
    """What the robot of this number slips."""
    return tuple((MEAN + SPREAD * np.random.default_rng(seed).standard_normal(2)).tolist())


def gentle_log(seed: int, seconds: float, slip: tuple[float, ...] | None = None) -> Log:
    """A robot that drives as robots mostly do, measured with noise."""
    alpha = robot_slip(seed) if slip is None else slip
    return simulated_log(
        Drive(seconds=seconds, seed=seed, basis=BASIS, alpha=alpha, lag=0.3, delay=0.1, **GENTLE, **NOISY)  # type: ignore[arg-type]
    )


@cache
def known_fleet(input_name: str = "wheel") -> tuple[tuple[str, LogKnowledge], ...]:
    """What logs of four robots say."""
    found = []
    for seed in range(4):
        known = calibrate_from(gentle_log(seed, 120.0), None, input=input_name)[1]
        assert known is not None
        found.append((f"robot-{seed}", known))
    return tuple(found)
