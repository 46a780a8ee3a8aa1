# SPDX-License-Identifier: Apache-2.0
"""Scores of drives whose errors are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from slipwise_sim.demo.closed_loop import Driven
from slipwise_sim.demo.slalom_drive import Trace
from slipwise_sim.demo.tracking_score import recovery_time, settled_error, tracking


def drive(after_change: float, recovered_after: float) -> Driven:
    """Return 60 s with 0.1 m, the floor changing after 30 s, where the error is larger for some seconds."""
    t = np.arange(1, 1201) / 20.0
    floor = (t > 30.0).astype(np.int64)
    disturbed = (t > 30.0) & (t <= 30.0 + recovered_after)
    left = np.where(disturbed, after_change, 0.1) * np.where(np.arange(1200) % 2, 1.0, -1.0)
    return Driven(Trace(t, np.column_stack((t, left)), left, floor), True)


def test_errors_count_to_both_sides() -> None:
    score = tracking(drive(0.4, 6.0), drive(0.1, 0.0))
    assert score.mean == pytest.approx(0.1 + 0.3 * 6.0 / 60.0)
    assert score.rms == pytest.approx(math.sqrt(0.01 + 0.15 * 6.0 / 60.0))
    assert score.worst == pytest.approx(0.4)
    assert score.seconds == pytest.approx(60.0)
    assert score.settled == pytest.approx((0.1, 0.1))


def test_recovery_is_when_the_error_is_that_of_the_floors_model_again() -> None:
    assert tracking(drive(0.4, 6.0), drive(0.1, 0.0)).recovery[0] == pytest.approx(6.0, abs=0.3)
    assert tracking(drive(0.1, 0.0), drive(0.1, 0.0)).recovery == (0.0,)
    assert tracking(drive(0.4, 30.0), drive(0.1, 0.0)).recovery == (math.inf,)


def test_a_floor_that_was_never_reached_has_no_scores() -> None:
    trace = drive(0.4, 6.0).trace
    assert math.isnan(settled_error(trace, 2))
    assert recovery_time(trace, 2, 1.0) == math.inf
