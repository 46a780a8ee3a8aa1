# SPDX-License-Identifier: Apache-2.0
"""A light wind that stays is found, and one that turns round is followed."""

from __future__ import annotations

import numpy as np
import pytest
from sample_slopes import commands_of

from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.logs.log import Inputs, Log, Poses, Run

WIND = 0.02  # m to the left of the map per metre driven
STEP = 0.01  # s, of the simulation


def windy(seed: int, *, turns_round: bool = False, seconds: float = 300.0) -> Log:
    """Return a log of wheels and poses of a robot that turns 20 % less than its wheels say."""
    random = np.random.default_rng(seed)
    t, v, omega = commands_of(random, seconds)
    fine_v, fine_omega = np.repeat(v, 10), np.repeat(omega, 10)
    yaw = 0.8 * STEP * (np.cumsum(fine_omega) - fine_omega)
    middle = yaw + 0.4 * STEP * fine_omega
    turned = turns_round & (np.arange(len(fine_v)) * STEP > 0.5 * seconds)
    push = WIND * np.abs(fine_v) * np.where(turned, -1.0, 1.0)
    steps = STEP * np.array([0.95 * fine_v * np.cos(middle), 0.95 * fine_v * np.sin(middle) + push])
    x, y = np.cumsum(steps, axis=1) - steps
    noise = random.normal(size=(3, len(t))) * [[0.005], [0.005], [0.004]]
    poses = Poses(t, *(np.array([x, y, yaw])[:, ::10] + noise), np.zeros(len(t), np.int64))
    return Log((Run("wind", None, Inputs(t, v, np.zeros_like(v), omega), poses),))


def learned(log: Log) -> Calibration:
    return calibrate(log, input="wheel", settings=make_settings({"body_force": {"frame": "world"}}))


@pytest.mark.parametrize("seed", [0, 1])
def test_a_light_wind_that_stays_is_found_within_five_minutes(seed: int) -> None:
    found = learned(windy(seed)).model["lat.abs(V)*cos(yaw)"]
    assert abs(found.value - WIND) < 3.0 * found.std
    assert found.std < 0.2 * WIND


def test_a_wind_that_turns_round_is_followed() -> None:
    found = learned(windy(0, turns_round=True)).model["lat.abs(V)*cos(yaw)"]
    assert abs(found.value + WIND) < 3.0 * found.std
