# SPDX-License-Identifier: Apache-2.0
"""Where models come from: one for all, one for each floor, or a learner that drives along."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from slipwise.calibration.motion_learner import MotionLearner
from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.models import Model
from slipwise.planning import vendor_motion
from slipwise_sim.demo.motion_sources import FixedMotion, FloorMotions, LiveMotion, push

UNTIL = [vendor_motion(1.6)]


def turning(seconds: float) -> Iterator[list[Sample]]:
    """Yield the samples of a robot that turns 0.7 times as much as its wheels say, 0.05 s at a time."""
    rng = np.random.Generator(np.random.PCG64(1))
    x = y = yaw = 0.0
    for step in range(int(seconds * 20.0)):
        t, v, omega = step / 20.0, 1.0, 0.8 * np.sin(step / 15.0)
        noise = 0.005 * rng.standard_normal(3)
        pose = Pose(t, float(x + noise[0]), float(y + noise[1]), float(yaw + 0.3 * noise[2]))
        yield [Command(t, v, omega), Wheels(t, v, omega), pose]
        x += 0.05 * v * np.cos(yaw + 0.0175 * omega)
        y += 0.05 * v * np.sin(yaw + 0.0175 * omega)
        yaw += 0.05 * 0.7 * omega


def learned() -> MotionLearner:
    """Return a learner that has seen a minute of `turning`."""
    learner = MotionLearner("command")
    learner.start_run("before")
    for samples in turning(60.0):
        push(learner, samples)
    return learner


@pytest.fixture(scope="module")
def model() -> Model:
    return learned().model(limits=False)


def test_a_fixed_model_is_given_once() -> None:
    source = FixedMotion(UNTIL)
    assert source.motions(0, []) == UNTIL
    assert source.motions(1, []) is None


def test_each_floor_has_its_model_from_its_first_moment_on(model: Model) -> None:
    source = FloorMotions([model, model])
    first = source.motions(0, [])
    assert first is not None
    assert np.array_equal(first[0].parameters, model.mean)
    assert source.motions(0, []) is None
    assert source.motions(1, []) is not None


def test_a_learner_gives_its_first_model_when_its_verdict_is_good_and_then_one_a_second_at_most() -> None:
    source = LiveMotion(MotionLearner("command"), UNTIL)
    assert source.motions(0, []) == UNTIL
    given = [samples[0].t for samples in turning(40.0) if source.motions(0, samples) is not None]  # type: ignore[union-attr]
    assert 5.0 < given[0] < 35.0
    assert (np.diff(given) >= 1.0 - 1e-9).all()
    assert len(given) > 2


def test_a_loaded_learner_gives_its_model_at_once() -> None:
    saved = MotionLearner.load(learned().save())
    first = LiveMotion(saved, UNTIL).motions(0, [])
    assert first is not None
    assert first[0].model.parameters != UNTIL[0].model.parameters
