# SPDX-License-Identifier: Apache-2.0
"""A verdict holds for the model that is handed on, as it is at the end, or says that it does not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, sound_log, stopped

from slipwise.calibration import calibrate
from slipwise.calibration.handed_on import HandedOn, handed_on
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import open_log

DRIVE = replace(SKID_STEERED, seconds=150.0, pose_std=(0.01, 0.005))
SAME = HandedOn((0.1, 0.02), (0.1, 0.02), (0.5, 0.1), (2.0, 0.5), 5.0)


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_of_a_robot_that_stopped_at_the_end_no_model_is_handed_on(input_name: str) -> None:
    sound = calibrate(sound_log(DRIVE), input=input_name)
    assert sound.verdict.good
    assert sound.verdict.reservations == ()
    log = stopped(sound_log(DRIVE), 132.0, 0.002)  # an eighth of it: less than spoils a log
    stuck = calibrate(log, input=input_name)
    assert not stuck.verdict.good
    assert "it was learned last while the robot did not move although it was driven" in stuck.verdict.sentence
    assert "As it is at the end" not in stuck.verdict.sentence
    assert "--start and --end leave such a time out." in stuck.verdict.advice


def test_what_is_clearly_worse_at_the_end_is_said_and_nothing_else() -> None:
    assert SAME.larger == {}
    assert SAME.sentence() == ""
    assert SAME.advice() == ()
    worse = replace(SAME, again=(0.2, 0.02))
    assert worse.larger == {"position": pytest.approx(2.0)}
    assert "misses the last segments by 0.2 m and 0.02 rad: its position error 2" in worse.sentence()
    assert "slipwise live" in worse.advice()[0]
    assert worse.fault({"does-not-move"}) == ""  # the baseline is worse
    assert replace(SAME, again=(0.6, 0.02)).fault(set()) == ""  # a change of ground may do that
    assert "baseline by 0.5 m" in replace(SAME, again=(0.6, 0.02)).fault({"does-not-move"})
    hardly = replace(SAME, judged=(0.01, 0.001), again=(0.05, 0.005))
    assert hardly.larger == {}  # five times as large, and of no concern


def test_the_same_segments_are_compared() -> None:
    predictions = calibrate(sound_log(DRIVE), input="wheel").predictions
    (longest,) = (each for each in predictions if each.horizon == 5.0)
    assert handed_on(longest, longest, np.zeros((3, 2))) is None
    errors = np.column_stack((longest.position_error, longest.heading_error))
    found = handed_on(longest, longest, errors)
    assert found is not None
    assert found.again == pytest.approx(found.judged)


@pytest.mark.slow
def test_limits_that_the_whole_log_contradicts_are_left_out(real_log_dir: Path) -> None:
    """Behind a dead band, a delay of 1 s came out of all of it: errors were 2.3 times those judged."""
    log = open_log(real_log_dir / "warthog" / "grass_7_18_16h59s20.csv.gz")
    model = calibrate(log, input="command").model
    scores = evaluate(log, input="command", options=EvaluationOptions(methods=("auto", "model"), model=model))
    assert scores.score("model", 1.0).position.mean < 1.2 * scores.score("auto", 1.0).position.mean
