# SPDX-License-Identifier: Apache-2.0
"""Learning from one measurement at a time gives what `calibrate` makes of the same log."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

import slipwise as sw
from slipwise import _core
from slipwise.errors import SlipwiseError
from slipwise.logs.log import Log


@pytest.fixture(scope="module")
def log() -> Log:
    return simulated_log(Drive(seconds=60.0, seed=4))


def rows_of(log: Log) -> list[tuple[float, int, tuple[float, ...]]]:
    """Every measurement of the only run in the order of the stamps."""
    (run,) = log.runs
    found = []
    for kind, inputs in enumerate((run.commands, run.wheels)):
        assert inputs is not None
        columns = (inputs.t, inputs.v, inputs.omega, inputs.vy)
        found += [(row[0], kind, row) for row in zip(*(column.tolist() for column in columns), strict=True)]
    poses = run.poses
    columns = (poses.t, poses.x, poses.y, poses.yaw)
    found += [(row[0], 2, row) for row in zip(*(column.tolist() for column in columns), strict=True)]
    return sorted(found)


def pushed(log: Log, input_name: str) -> sw.MotionLearner:
    learner = sw.MotionLearner(input=input_name)
    learner.start_run("monday")
    push = (learner.push_command, learner.push_wheels, learner.push_pose)
    for _, kind, row in rows_of(log):
        push[kind](*row)
    return learner


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_what_is_pushed_is_what_calibrate_learns(log: Log, input_name: str) -> None:
    model, learned = pushed(log, input_name).model(), sw.calibrate(log, input=input_name).model
    assert model.content.parameters == learned.content.parameters
    assert model.content.covariance == learned.content.covariance
    assert model.content.noise == learned.content.noise
    assert model.content.verdict.held_out == learned.content.verdict.held_out
    assert model.content.range == learned.content.range


def test_a_path_starts_at_the_newest_measurement_and_says_how_sure_it_is(log: Log) -> None:
    learner = pushed(log, "wheel")
    path = learner.predict([(60.1, 0.5, 0.2)], horizon=5.0)
    assert path.start == pytest.approx(max(t for t, _, _ in rows_of(log)))
    assert path.t[-1] == pytest.approx(path.start + 5.0)
    assert path.poses.shape == (len(path.t), 3)
    assert np.linalg.eigvalsh(path.covariance).min() > 0.0
    assert path.dof > 2.0


def test_asking_changes_nothing_that_is_learned(log: Log) -> None:
    asked, silent = sw.MotionLearner("wheel"), sw.MotionLearner("wheel")
    for learner in (asked, silent):
        learner.start_run("monday")
    for i, (t, kind, row) in enumerate(rows_of(log)):
        for learner in (asked, silent):
            (learner.push_command, learner.push_wheels, learner.push_pose)[kind](*row)
        if i % 211 == 210:
            asked.predict([(t + 0.1, 0.4, -0.2)], horizon=2.0)
        if i % 997 == 996 and t > 10.0:
            asked.model()
    assert asked.model().content == silent.model().content


def test_what_is_wrong_is_said_and_changes_nothing(log: Log) -> None:
    learner = sw.MotionLearner("wheel")
    learner.start_run("monday")
    for i, (t, kind, row) in enumerate(rows_of(log)):
        (learner.push_command, learner.push_wheels, learner.push_pose)[kind](*row)
        if i % 500 == 250:
            learner.push_pose(t + 1e-4, float("nan"), 0.0, 0.0)
            learner.push_wheels(t - 30.0, 1.0, 0.0)
            learner.push_wheels(float("inf"), 1e300, 0.0)
    events = learner.events()
    assert {event.kind for event in events} == {"segment-learned", "rejected", "held-out"}
    assert {event.reason for event in events if event.kind == "rejected"} >= {
        "a number is missing or impossible",
        "the stamp goes backward",
    }
    assert all(event.run == "monday" for event in events)
    assert learner.events() == []
    assert learner.model().content.covariance == pushed(log, "wheel").model().content.covariance


def test_forgetting_makes_slip_less_sure() -> None:
    slipping = Drive(seconds=60.0, seed=4, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.4))
    learner = pushed(simulated_log(slipping), "wheel")
    before = learner.model()
    learner.forget(0.5)
    after = learner.model()
    place = [parameter.name for parameter in before.content.parameters].index("ang.w")
    assert after.content.parameters[place].std > before.content.parameters[place].std
    with pytest.raises(SlipwiseError, match="between 0 and 1"):
        learner.forget(1.5)


def test_too_little_is_said_in_one_line() -> None:
    learner = sw.MotionLearner("command")
    learner.start_run("empty")
    with pytest.raises(SlipwiseError, match="nothing was learned yet"):
        learner.model()
    with pytest.raises(SlipwiseError, match="nothing was measured"):
        learner.predict([(0.0, 1.0, 0.0)], horizon=1.0)
    with pytest.raises(SlipwiseError, match="unknown input"):
        sw.MotionLearner("gps")
