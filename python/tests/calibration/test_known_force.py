# SPDX-License-Identifier: Apache-2.0
"""A known force acts as gravity does, on the whole over each segment (force_buffer)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_logs import STEP, Drive, commands, poses_of

from slipwise import _core
from slipwise.calibration import calibrate, make_settings
from slipwise.errors import LogError
from slipwise.logs import Inputs, Log, Run
from slipwise.logs.log import Forces

GIVES = 0.03  # s^2/m, of the slip to the side per speed and force over the mass


def pushed_log(seconds: float = 120.0, *, told: bool = True, late: int = 0, blow: float = 10.0) -> Log:
    """A blade pushes to one side and the other for some seconds each, by 1.5 m/s^2; it is said rows late."""
    rng = np.random.default_rng(3)
    t, v, omega = commands(Drive(seconds=seconds), rng)
    force = np.where((t // blow) % 2.0 == 0.0, 1.5, -1.5)
    basis = _core.Basis("true", ["V"], ["gy*abs(V)"], ["w"])
    pose, path = _core.Pose2(0.0, 0.0, 0.0), np.empty((len(t), 3))
    for i in range(len(t)):
        path[i] = pose.vector()
        state = _core.SlipState(v[i], omega[i], 0.0, force[i])
        slip = _core.slip_rate(basis, np.array([-0.05, GIVES, -0.2]), state)
        noise = 2e-3 * np.sqrt(STEP) * rng.standard_normal(3)
        pose = _core.compose(pose, _core.exp((np.array([v[i], 0.0, omega[i]]) + slip) * STEP + noise))
    path += rng.standard_normal(path.shape) * (0.005, 0.005, 0.002)
    inputs = Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega)
    poses = poses_of(t, path)
    said = Forces(t, np.zeros_like(t), np.roll(force, late)) if told else None
    return Log(runs=(Run(name="blade", commands=None, wheels=inputs, poses=poses, forces=said),))


def test_a_force_that_changes_within_a_window_is_learned_as_it_acts() -> None:
    settings = make_settings({"basis": "drive-9"})
    for late in (0, 1):
        gives = calibrate(pushed_log(late=late, blow=2.6), input="wheel", settings=settings).model[
            "lat.abs(V)*gy"
        ]
        assert abs(gives.value - GIVES) < 0.1 * GIVES, (late, gives.value)


def test_a_known_force_beside_an_attitude_is_refused() -> None:
    log = pushed_log(20.0)
    (run,) = log.runs
    tilted = replace(run.poses, roll=np.full(len(run.poses), 0.05), pitch=np.zeros(len(run.poses)))
    with pytest.raises(LogError, match="roll and pitch and a known force"):
        calibrate(Log(runs=(replace(run, poses=tilted),)), input="wheel")
