# SPDX-License-Identifier: Apache-2.0
"""On a course whose floor changes, the live learner keeps nearer to the path than a vendor's constants."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.calibration.motion_learner import MotionLearner
from slipwise_sim.demo.closed_loop import Driven, drive_course, vendor
from slipwise_sim.demo.motion_sources import FixedMotion, LiveMotion, MotionSource
from slipwise_sim.demo.slalom_course import slalom_course

pytestmark = pytest.mark.slow

pytest.importorskip("mujoco", reason="simulation needs MuJoCo")

COURSE = slalom_course(7, stretch=30.0)


def drive(source: MotionSource) -> Driven:
    """Drive the course."""
    return drive_course(COURSE, source, seed=7)


def test_a_live_learner_tracks_better_and_arrives_sooner_than_a_vendors_constants() -> None:
    constants = drive(FixedMotion(vendor()))
    live = drive(LiveMotion(MotionLearner("command"), vendor()))
    assert live.arrived
    errors = [np.abs(driven.trace.left).mean() for driven in (live, constants)]
    assert errors[0] < 0.6 * errors[1]
    assert live.trace.t[-1] < 0.8 * constants.trace.t[-1]
    assert set(live.trace.floor) == {0, 1, 2}
