# SPDX-License-Identifier: Apache-2.0
"""A drive for the tests of logs: a robot that follows its commands exactly, with a pose at 10 Hz."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from slipwise.logs import Inputs, Log, Poses, Run


def make_run(name: str = "drive", *, seconds: float = 120.0, seed: int = 1, start: float = 0.0) -> Run:
    """Drive for a while, forward and backward, left and right, with a new random command every 2 s."""
    rng = np.random.default_rng(seed)
    t = start + np.round(np.arange(0.0, seconds, 0.05), 3)
    hold = (np.arange(len(t)) // 40).astype(int)
    v = rng.uniform(-0.8, 2.0, hold[-1] + 1)[hold]
    omega = rng.uniform(-1.0, 1.0, hold[-1] + 1)[hold]
    yaw = np.concatenate([[0.0], np.cumsum(omega * 0.05)[:-1]])
    middle = yaw + 0.5 * omega * 0.05
    x = np.concatenate([[0.0], np.cumsum(v * np.cos(middle) * 0.05)[:-1]])
    y = np.concatenate([[0.0], np.cumsum(v * np.sin(middle) * 0.05)[:-1]])
    inputs = Inputs(t=t, v=v, vy=np.zeros(len(t)), omega=omega)
    fresh = slice(None, None, 2)
    wrapped = np.arctan2(np.sin(yaw), np.cos(yaw))
    poses = Poses(
        t=t[fresh],
        x=x[fresh],
        y=y[fresh],
        yaw=wrapped[fresh],
        frame=np.zeros(len(t[fresh]), np.int64),
        std_xy=np.full(len(t[fresh]), 0.02),
        std_yaw=np.full(len(t[fresh]), 0.01),
    )
    return Run(name=name, commands=inputs, wheels=inputs, poses=poses)


@pytest.fixture
def drive() -> Callable[..., Run]:
    return make_run


@pytest.fixture
def run() -> Run:
    return make_run()


@pytest.fixture
def log(run: Run) -> Log:
    return Log(runs=(run,))
