# SPDX-License-Identifier: Apache-2.0
"""A mecanum platform with rollers drives where its wheels say, less a creep that is recovered."""

from __future__ import annotations

import numpy as np
import pytest

import slipwise as sw
from slipwise.calibration import make_settings
from slipwise.logs.log import Inputs, Poses
from slipwise_sim.mecanum import MecanumPlatform, mecanum_log, mecanum_mjcf

pytest.importorskip("mujoco")
STEP = 0.05  # s


def held(twist: tuple[float, float, float], seconds: float) -> Inputs:
    t = np.arange(0.0, seconds, STEP)
    return Inputs(t, *(np.full(len(t), value) for value in twist))


def weaving(seconds: float, seed: int) -> Inputs:
    """Twists that are held for 1.5 s each."""
    t = np.arange(0.0, seconds, STEP)
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (len(t) // 30 + 1, 3)) * (0.5, 0.4, 0.6)
    v, vy, omega = (np.ascontiguousarray(column) for column in drawn[np.arange(len(t)) // 30].T)
    return Inputs(t, v, vy, omega)


def poses_of(commands: Inputs, platform: MecanumPlatform | None = None) -> Poses:
    return mecanum_log(platform or MecanumPlatform(), commands, pose_noise=(0.0, 0.0)).runs[0].poses


def test_every_wheel_has_its_rollers() -> None:
    text = mecanum_mjcf(MecanumPlatform(rollers=8))
    assert text.count('type="ellipsoid"') == 4 * 8
    assert text.count("<velocity ") == 4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("twist", "part"), [((0.5, 0.0, 0.0), 0), ((0.0, 0.4, 0.0), 1), ((0.0, 0.0, 0.8), 2)]
)
def test_it_goes_where_it_is_told(twist: tuple[float, float, float], part: int) -> None:
    poses = poses_of(held(twist, 2.0))
    moved = np.array([poses.x[-1], poses.y[-1], poses.yaw[-1]])
    told = np.array(twist) * poses.t[-1]
    assert 0.85 * told[part] < moved[part] < 1.02 * told[part]
    assert np.abs(np.delete(moved, part)).max() < 0.06


@pytest.mark.slow
def test_its_creep_ahead_and_sideways_is_recovered() -> None:
    log = mecanum_log(MecanumPlatform(), weaving(90.0, 3))
    model = sw.calibrate(log, settings=make_settings({"basis": "omni-8"})).model
    ahead, aside = poses_of(held((0.4, 0.0, 0.0), 3.0)), poses_of(held((0.0, 0.4, 0.0), 3.0))
    late = len(ahead) // 2  # where the start is over
    steady = ahead.t[-1] - ahead.t[late]
    creep = {
        "lon.V": (ahead.x[-1] - ahead.x[late]) / (0.4 * steady) - 1.0,
        "lat.Vy": (aside.y[-1] - aside.y[late]) / (0.4 * steady) - 1.0,
    }
    for name, true in creep.items():
        found = model[name]
        assert found.identified
        assert abs(found.value - true) < 3.0 * found.std + 0.01


@pytest.mark.slow
def test_terms_of_sideways_speed_predict_better_than_those_without() -> None:
    log = mecanum_log(MecanumPlatform(), weaving(90.0, 3))
    options = sw.EvaluationOptions(horizons=(2.0,), methods=("none", "full-linear-6", "omni-8", "auto"))
    position = {score.method: score.position.mean for score in sw.evaluate(log, options=options).scores}
    assert position["omni-8"] < 0.9 * position["full-linear-6"]
    assert position["auto"] < 0.7 * position["none"]
