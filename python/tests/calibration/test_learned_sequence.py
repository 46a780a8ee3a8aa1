# SPDX-License-Identifier: Apache-2.0
"""What a learner says of the surfaces of a sequence."""

from __future__ import annotations

import numpy as np
import pytest
from sample_logs import Drive, simulated_log
from sample_surfaces import floor_log

from slipwise import _core
from slipwise.calibration.learned_sequence import SequenceOptions, learn_sequence
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings

EDD_2 = _core.named_basis("edd-2")


def test_one_surface_all_the_time_is_one_surface() -> None:
    drives = [prepare_run(simulated_log(Drive(seconds=60.0, seed=seed)), "wheel") for seed in range(3)]
    done: list[float] = []
    learned = learn_sequence(drives, Settings(), (1.0,), progress=done.append)
    assert len(learned.surfaces) == 1
    assert learned.surfaces[0].visits == 3
    assert learned.surfaces[0].seconds > 150.0
    assert learned.surfaces[0].speed > 0.0
    assert [log.surface for log in learned.logs] == ["surface 1"] * 3
    assert any(change.what == "recalled" for change in learned.logs[1].changes)
    assert done[-1] == 1.0
    assert done == sorted(done)


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


def visited(slips: list[tuple[float, float]], labels: tuple[str, ...] = ()) -> list[str]:
    """Return the names of the surfaces that are remembered after drives on these."""
    drives = [prepare_run(floor_log(slip, seed), "wheel") for seed, slip in enumerate(slips)]
    learned = learn_sequence(drives, Settings(), (1.0,), options=SequenceOptions(labels=labels))
    return [surface.name for surface in learned.surfaces]


@pytest.mark.slow
def test_surfaces_that_are_alike_become_one_under_their_name() -> None:
    alike = [(-0.05, -0.3), (-0.05, -0.301), (-0.05, -0.3)]
    assert visited(alike) == ["surface 1"]
    assert visited(alike[:2], ("hall", "hall")) == ["hall"]
