# SPDX-License-Identifier: Apache-2.0
"""What a learner says of the surfaces of a sequence."""

from __future__ import annotations

import numpy as np
from sample_logs import Drive, simulated_log

from slipwise import _core
from slipwise.calibration.motion_learner import MotionLearner

EDD_2 = _core.named_basis("edd-2")


def test_the_learner_of_a_robot_puts_its_surfaces_into_the_model() -> None:
    learner = MotionLearner("wheel", remember=True)
    for seed in range(2):
        learner.start_drive(f"drive {seed}", label="hall", date="2026-01-01")
        drive = Drive(seconds=60.0, seed=seed, basis=EDD_2, alpha=(-0.1, -0.4))
        run = simulated_log(drive).runs[0]
        assert run.wheels is not None
        for t, v, omega in zip(run.wheels.t, run.wheels.v, run.wheels.omega, strict=True):
            learner.push_wheels(100.0 * seed + t, v, omega)
            for i in np.flatnonzero(run.poses.t == t):
                learner.push_pose(100.0 * seed + t, run.poses.x[i], run.poses.y[i], run.poses.yaw[i])
    (hall,) = learner.surfaces()
    assert (hall.name, hall.visits, hall.last_seen) == ("hall", 2, "2026-01-01")
    (section,) = learner.model(limits=False).content.surfaces
    assert section.name == "hall"
    assert MotionLearner.load(learner.save()).surfaces() == (hall,)
