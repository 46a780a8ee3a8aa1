# SPDX-License-Identifier: Apache-2.0
"""A robot that drives sideways: predictions, rollouts, futures, the controller and learners say the same."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_models import LIMITS, Made, make_model

import slipwise as sw
from slipwise import _core
from slipwise.errors import ModelError, SettingsError
from slipwise.export import export_model
from slipwise.models import Model
from slipwise.models.axes import LEAST_SIDEWAYS, SIDEWAYS, axes_of, sideways_span
from slipwise.planning import Controller, MppiOptions, ReferencePath, Start, rollout, sample_futures
from slipwise.prediction import predict

Floats = NDArray[np.float64]

DT, K, N = 0.1, 20, 9
OMNI = _core.named_basis("omni-8")


def omni(*, limits: bool = False, **other: bool) -> Model:
    slip = np.random.default_rng(3).uniform(-0.15, 0.15, OMNI.size).tolist()
    names = [info.name for info in _core.MotionModel(OMNI, False, False).parameters]
    values = dict(zip(names, slip, strict=True))
    held = {"speed": LIMITS["speed"], "yaw_rate": LIMITS["yaw_rate"]} if limits else None
    return make_model(Made(OMNI, values, limits=held, **other))


MODELS = {
    "wheels": omni(),
    "commands": omni(commands=True),
    "limits": omni(commands=True, limits=True),
    "slow mode": omni(response=True),
}


@pytest.fixture(scope="module")
def commands() -> Floats:
    random = np.random.default_rng(5)
    spans = ((-0.4, 1.2), (-0.6, 0.6), (-0.6, 0.6))
    return np.stack([random.uniform(*span, (N, K)) for span in spans], axis=2)


def test_covariance_and_futures_know_the_sideways_speed(commands: Floats) -> None:
    model = MODELS["commands"]
    start = Start(past=np.zeros((20, 3)), drive=(0.0, 0.2, 0.0))
    found = rollout(model, commands, DT, start=start, dtype=np.float64, covariance=True)
    assert found.path is not None
    assert found.covariance is not None
    drawn = sample_futures(model, commands, DT, samples=200, seed=1, start=start)
    assert drawn.mean(axis=1)[:2, -1] == pytest.approx(found.path[:2, -1], abs=0.05)
    assert drawn[1, :, -1].var(axis=0) == pytest.approx(found.covariance[2, -1], rel=0.4)


def test_rows_of_other_axes_are_refused_and_the_axes_are_said(commands: Floats) -> None:
    model, plain = MODELS["commands"], make_model(Made(_core.named_basis("edd-2")))
    assert axes_of(model) is SIDEWAYS
    rows = np.column_stack((np.arange(3) * DT, np.ones((3, 2))))
    reference = ReferencePath(np.array([[0.0, 0.0], [5.0, 0.0]]), 0.5)
    uses = {
        "predict": (lambda: predict(model, rows, horizon=1.0), r"t, v, vy, omega"),
        "initial": (
            lambda: predict(model, np.column_stack((rows, rows[:, 0])), horizon=1.0, initial=(0.1, 0.0)),
            r"\(v \[m/s\], vy \[m/s\], omega \[rad/s\]\)",
        ),
        "rollout": (lambda: rollout(model, commands[..., :2], DT), r"vy \[m/s\]"),
        "futures": (lambda: sample_futures(model, commands[..., :2], DT, samples=1, seed=1), r"vy \[m/s\]"),
        "past": (lambda: rollout(model, commands, DT, start=Start(past=np.zeros((4, 2)))), r"vy \[m/s\]"),
        "controller": (lambda: Controller(model, reference).command((0.0, 0.0, 0.0), (0.0, 0.0)), "vy"),
        "plain": (lambda: rollout(plain, commands, DT), r"\(v \[m/s\], omega \[rad/s\]\)"),
        "plain rows": (
            lambda: predict(plain, np.column_stack((rows, rows[:, 0])), horizon=1.0),
            r"t, v, omega",
        ),
    }
    for name, (use, words) in uses.items():
        with pytest.raises(SettingsError, match=words):
            print(name, use())


def test_uses_without_a_sideways_speed_are_refused_with_those_that_have_it() -> None:
    model = MODELS["commands"]
    for use in (
        lambda: sw.planning.curvature_map(model),
        lambda: export_model(model, "diff-drive", name="model.yaml"),
    ):
        with pytest.raises(ModelError, match=r"sideways.*rollout"):
            use()


def test_a_trajectory_of_a_sideways_robot_goes_none_sideways_and_reaches_its_goal() -> None:
    model = MODELS["commands"]
    plan = sw.planning.trajectory_to(model, (2.0, 0.6, 0.5))
    assert plan.commands.shape[1] == 4
    assert not plan.commands[:, 2].any()
    before = np.vstack(([-10.0, 0.0, 0.0, 0.0], plan.commands))
    end = predict(model, before, horizon=plan.duration, start=0.0).end
    assert end == pytest.approx([2.0, 0.6, 0.5], abs=2e-3)
    sure = sw.planning.uncertain_path(model, plan)
    assert sure.end == pytest.approx(end, abs=2e-3)


def test_the_controller_drives_sideways_where_that_is_the_way() -> None:
    model = MODELS["wheels"]
    reference = ReferencePath(np.array([[0.0, 0.4], [3.0, 0.4]]), 0.4)
    options = MppiOptions(rollouts=256, periods=20, period=DT, seed=2)
    controller = Controller(model, reference, options=options)
    pose, told = _core.Pose2(0.0, 0.0, 0.0), []
    for _ in range(40):
        drive = told[-1] if told else (0.0, 0.0, 0.0)
        command = controller.command(tuple(pose.vector().tolist()), drive)
        told.append(command)
        step = rollout(model, np.array([[command]]), DT, start=Start(pose=pose.vector()), dtype=np.float64)
        assert step.path is not None
        pose = _core.Pose2(*step.path[:, 0, 0].tolist())
    _, y, yaw = pose.vector().tolist()
    assert y == pytest.approx(0.4, abs=0.05)
    assert abs(yaw) < 0.2
    aside = np.array(told)[:, 1]
    assert aside.max() > 0.1
    assert np.abs(aside).max() <= options.sideways_speed + 1e-6
    assert np.abs(np.diff(aside)).max() <= options.sideways_acceleration * DT + 1e-6


def test_what_drives_sideways_is_an_axis_and_noise_of_odometry_is_none() -> None:
    v = np.array([1.0, 0.8])
    assert sideways_span(v, np.array([0.0, 0.9 * LEAST_SIDEWAYS])) is None
    assert sideways_span(v, np.array([-0.3, 0.1])) == [-0.3, 0.1]


def test_a_learner_asks_for_the_axes_that_were_pushed_and_keeps_them_in_its_model() -> None:
    learner = sw.MotionLearner(input="command")
    learner.start_run("monday")
    pose = _core.Pose2(0.0, 0.0, 0.0)
    for k in range(400):
        t = 0.05 * k
        command = (0.5, 0.4 * np.sin(0.7 * t), 0.3 * np.cos(0.5 * t))
        if k % 2 == 0:
            learner.push_pose(t, *pose.vector().tolist())
        learner.push_command(t, command[0], command[2], command[1])
        pose = _core.compose(pose, _core.exp(0.05 * np.array(command)))
    ahead = np.array([[20.0, 0.0, 0.4, 0.0]])
    with pytest.raises(SettingsError, match="t, v, vy, omega"):
        learner.predict(ahead[:, :3], horizon=1.0)
    path = learner.predict(ahead, horizon=1.0)
    assert path.poses[-1, 1] == pytest.approx(0.4, abs=0.05)
    assert path.poses[-1, 0] == pytest.approx(0.0, abs=0.05)
    model = sw.MotionLearner.load(learner.save()).model()
    assert axes_of(model) is SIDEWAYS
    assert axes_of(sw.models.parse_model(model.to_yaml(), where="text")) is SIDEWAYS
    expected = predict(model, np.array([[20.0, 0.0, 0.4, 0.0]]), horizon=1.0, initial=(0.0, 0.4, 0.0)).end
    assert expected[1] == pytest.approx(0.4, abs=0.05)
