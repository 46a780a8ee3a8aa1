# SPDX-License-Identifier: Apache-2.0
"""The model file says how fast the poses show the body, not the command times a learned gain."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.calibration.learned_log import pushed
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import prepare_run

SKID = Drive(
    seconds=120.0,
    seed=4,
    basis=_core.named_basis("edd-2"),
    alpha=(-0.1, -0.5),
    lag=0.1,
    delay=0.1,
    hold=(60, 120),
)


def test_rates_are_those_of_the_body() -> None:
    model = calibrate(simulated_log(SKID), input="command").model
    span = model.content.range
    assert span.body is not None
    assert span.body.yaw_rate[1] == pytest.approx(0.5 * span.yaw_rate[1], rel=0.08)
    assert span.body.speed[1] == pytest.approx(0.9 * span.speed[1], rel=0.05)
    assert span.body.seconds > 100.0
    assert 3.0 <= span.body.held[1] < 15.0  # two in a row may be alike


def test_a_learner_measures_what_calibrate_does_and_keeps_it_when_saved() -> None:
    log = simulated_log(replace(SKID, seconds=40.0))
    wanted = calibrate(log, input="command").model.content.range.body
    drive = prepare_run(log, "command")
    again = MotionLearner("command")
    for _ in pushed(again._core, drive):
        pass
    assert again.model().content.range.body == wanted
    assert MotionLearner.load(again.save()).model().content.range.body == wanted
