# SPDX-License-Identifier: Apache-2.0
"""The tightest curves of a robot that steers: those that it was commanded and drove."""

import numpy as np
import pytest

from slipwise.calibration.driven_curvature import driven_curvature
from slipwise.calibration.shares import DISTANCE, DURATION, TURN
from slipwise.logs.log import Floats

SECONDS = 1.5
FORWARD, ROTATION, KNOWN = 9, 11, 12  # columns of commands in `_core` rows


def windows(*, stop: float = np.inf, windows: int = 300) -> Floats:
    """Windows of a car that is commanded up to 0.8 1/m; of that 0.9 arrives, up to its stop [1/m]."""
    rng = np.random.default_rng(5)
    speed, curvature = rng.uniform(0.0, 2.0, windows), rng.uniform(-0.8, 0.8, windows)
    rows = np.zeros((windows, 19))
    rows[:, DURATION] = rows[:, KNOWN] = SECONDS
    rows[:, FORWARD], rows[:, ROTATION] = speed * SECONDS, curvature * speed * SECONDS
    rows[:, DISTANCE] = np.abs(speed * SECONDS + rng.normal(0.0, 0.01, windows))
    rows[:, TURN] = np.clip(0.9 * curvature, -stop, stop) * speed * SECONDS + rng.normal(0.0, 0.02, windows)
    return rows


def test_curves_are_as_tight_as_commanded() -> None:
    assert driven_curvature(windows(), "command") == pytest.approx(0.8, rel=0.05)


def test_a_steering_at_its_stop_turns_no_tighter() -> None:
    assert driven_curvature(windows(stop=0.27), "command") == pytest.approx(0.3, rel=0.15)


def test_a_command_that_no_body_drove_is_none() -> None:
    rows = windows()
    rows[:2, ROTATION] = 10.0 * rows[:2, FORWARD]
    assert driven_curvature(rows, "command") == pytest.approx(0.8, rel=0.05)


def test_few_windows_tell_nothing() -> None:
    assert driven_curvature(windows(windows=10), "command") is None
    assert driven_curvature(windows(), "wheel") is None
