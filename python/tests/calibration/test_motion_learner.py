# SPDX-License-Identifier: Apache-2.0
"""Learning from one measurement at a time gives what `calibrate` makes of the same log."""

from __future__ import annotations

import pickle
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from sample_logs import Drive, simulated_log

import slipwise as sw
from slipwise import _core
from slipwise.errors import SlipwiseError
from slipwise.logs.log import Log

Row = tuple[float, int, tuple[float, ...]]  # its stamp, the stream, what is pushed


@cache
def drive() -> Log:
    return simulated_log(Drive(seconds=60.0, seed=4))


@pytest.fixture(scope="module")
def log() -> Log:
    return drive()


def rows_of(log: Log) -> list[Row]:
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


@cache
def saved_after(input_name: str) -> bytes:
    """A learner of the whole drive, as it is saved."""
    learner = sw.MotionLearner(input=input_name)
    learner.start_run("monday")
    push_rows(learner, rows_of(drive()))
    return learner.save()


def pushed(input_name: str) -> sw.MotionLearner:
    return sw.MotionLearner.load(saved_after(input_name))


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_what_is_pushed_is_what_calibrate_learns(log: Log, input_name: str) -> None:
    model, learned = pushed(input_name).model(), sw.calibrate(log, input=input_name).model
    assert model.content.parameters == learned.content.parameters
    assert model.content.covariance == learned.content.covariance
    assert model.content.noise == learned.content.noise
    assert model.content.verdict.held_out == learned.content.verdict.held_out
    assert model.content.verdict.advice == learned.content.verdict.advice
    assert model.limits_section == learned.limits_section
    assert model.content.range == learned.content.range


def test_a_path_starts_at_the_newest_measurement_and_says_how_sure_it_is(log: Log) -> None:
    learner = pushed("wheel")
    path = learner.predict([(60.1, 0.5, 0.2)], horizon=5.0)
    assert path.start == pytest.approx(max(t for t, _, _ in rows_of(log)))
    assert path.t[-1] == path.start + 5.0
    assert len(path.t) == 5
    assert np.all(np.diff(path.t) > 0.8)
    assert path.poses.shape == (5, 3)
    assert path.covariance.shape == (5, 3, 3)
    assert np.linalg.eigvalsh(path.covariance).min() > 0.0
    assert np.all(path.dof > 2.0)


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_each_pose_of_a_path_is_where_a_shorter_path_ends(log: Log, input_name: str) -> None:
    learner, inputs = pushed(input_name), [(60.1, 0.5, 0.2), (61.53, 0.2, -0.4)]
    path = learner.predict(inputs, horizon=5.0)
    for i, t in enumerate(path.t):
        shorter = learner.predict(inputs, horizon=t - path.start)
        np.testing.assert_allclose(shorter.poses[-1], path.poses[i], atol=1e-9)
        np.testing.assert_allclose(shorter.covariance[-1], path.covariance[i], atol=1e-9)
        assert shorter.dof[-1] == path.dof[i]


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
            asked.model(limits=False)
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
    assert {event.kind for event in events} == {"segment-learned", "rejected", "held-out", "refit"}
    assert {event.reason for event in events if event.kind == "rejected"} >= {
        "a number is missing or impossible",
        "the stamp goes backward",
    }
    assert all(event.run == "monday" for event in events)
    assert learner.events() == []
    assert learner.model().content.covariance == pushed("wheel").model().content.covariance


def test_a_learner_that_follows_no_disturbance_has_a_model_without_one(log: Log) -> None:
    settings = sw.make_settings({"slip_disturbance": {"learn": False}})
    learner = sw.MotionLearner("command", settings)
    learner.start_run("run")
    push_rows(learner, rows_of(log))
    assert learner.model(limits=False).content.slip_disturbance is None
    assert sw.calibrate(log, input="command", settings=settings).model.content.slip_disturbance is None


def test_a_wheelbase_of_a_robot_that_is_commanded_sideways_is_a_contradiction_of_the_stream() -> None:
    learner = sw.MotionLearner(input="command", wheelbase=0.5)
    learner.start_run("omni")
    for k in range(200):
        learner.push_command(0.1 * k, 0.5, 0.2, 0.0 if k < 100 else 0.3)
        learner.push_pose(0.1 * k, 0.05 * k, 0.0, 0.0)
        kinds = [each.kind for each in learner.contradictions()]
        assert ("not-steered" in kinds) == (k >= 100)


def test_too_little_is_said_in_one_line() -> None:
    learner = sw.MotionLearner("command")
    learner.start_run("empty")
    with pytest.raises(SlipwiseError, match="nothing was learned yet"):
        learner.model()
    with pytest.raises(SlipwiseError, match="nothing was measured"):
        learner.predict([(0.0, 1.0, 0.0)], horizon=1.0)
    with pytest.raises(SlipwiseError, match="unknown input"):
        sw.MotionLearner("gps")


def test_forces_ahead_are_rows_after_the_newest_measurement(log: Log) -> None:
    learner, _ = first_half(log, "command")
    now, inputs = learner._core.newest, [(learner._core.newest + 0.1, 0.5, 0.0)]
    without = learner.predict(inputs, horizon=1.0).poses
    pushed = learner.predict(inputs, horizon=1.0, forces=[(now + 0.1, 0.0, 0.5)]).poses
    np.testing.assert_allclose(pushed[-1], without[-1], atol=1e-9)  # its model has no terms of gravity
    for wrong in ([(now + 0.1, 0.5)], [(now - 1.0, 0.0, 0.5)], [(now + 0.1, 0.0, np.inf)]):
        with pytest.raises(SlipwiseError, match="forces"):
            learner.predict(inputs, horizon=1.0, forces=wrong)


def first_half(log: Log, input_name: str) -> tuple[sw.MotionLearner, list[Row]]:
    """A learner of the first half of the rows, and the others."""
    learner, rows = sw.MotionLearner(input_name), rows_of(log)
    learner.start_run("monday")
    push_rows(learner, rows[: len(rows) // 2])
    return learner, rows[len(rows) // 2 :]


def push_rows(learner: sw.MotionLearner, rows: list[Row]) -> None:
    for _, kind, row in rows:
        (learner.push_command, learner.push_wheels, learner.push_pose)[kind](*row)


@pytest.mark.parametrize("input_name", ["wheel", "command"])
def test_a_learner_that_was_saved_goes_on_as_it_was(log: Log, input_name: str) -> None:
    learner, rest = first_half(log, input_name)
    saved = learner.save()
    moved = [sw.MotionLearner.load(saved), pickle.loads(pickle.dumps(learner))]  # noqa: S301
    push_rows(learner, rest)
    for other in moved:
        push_rows(other, rest)
        assert other.save() == learner.save()
        assert other.model().content == learner.model().content


def test_settings_are_saved_with_it(log: Log) -> None:
    settings = sw.Settings(basis="edd-2", segment={"length": 1.5})
    learner = sw.MotionLearner("wheel", settings)
    other = sw.MotionLearner.load(learner.save())
    for each in (learner, other):
        each.start_run("monday")
        push_rows(each, rows_of(log))
    assert other.model().content == learner.model().content
    assert list(other.model().content.weights) == ["edd-2"]


def test_it_goes_on_in_another_process(log: Log, tmp_path: Path) -> None:
    learner, _ = first_half(log, "command")
    (tmp_path / "saved").write_bytes(learner.save())
    program = (
        "import sys; from pathlib import Path; import slipwise as sw\n"
        "saved = Path(sys.argv[1]).read_bytes()\n"
        "sys.stdout.buffer.write(sw.MotionLearner.load(saved).save())"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "saved")], capture_output=True, check=True
    )
    assert run.stdout == learner.save()


def test_what_is_no_saved_learner_is_refused_with_what_to_do(log: Log) -> None:
    saved = first_half(log, "wheel")[0].save()
    altered = bytearray(saved)
    altered[len(saved) // 2] ^= 1
    sealed = [_core.sealed(body) for body in (b"", b"\xff" * 40, (2).to_bytes(8, "little") + b"{}")]
    for bad in (b"", b"PK", saved[:-1], saved[: len(saved) // 2], bytes(altered), *sealed):
        with pytest.raises(SlipwiseError, match="saved"):
            sw.MotionLearner.load(bad)
