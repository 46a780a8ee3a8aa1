# SPDX-License-Identifier: Apache-2.0
"""A drive measures at its rates, changes the floor where the course says, and repeats for the same seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slipwise.live.samples import Command, Pose, Sample, Wheels
from slipwise.planning import baseline_motion, vendor_motion
from slipwise_sim.demo.slalom_course import FLOORS, slalom_course
from slipwise_sim.demo.slalom_drive import OPTIONS, SlalomDrive

pytest.importorskip("mujoco", reason="simulation needs MuJoCo")

COURSE = slalom_course(1, stretch=10.0)
FEW = replace(OPTIONS, rollouts=128)


def driven(seed: int, periods: int) -> tuple[SlalomDrive, list[Sample]]:
    """Drive for some control periods by a vendor's constants."""
    drive = SlalomDrive(COURSE, [vendor_motion(1.6)], seed=seed, options=FEW)
    return drive, [sample for _ in range(periods) for sample in drive.advance()]


def test_poses_and_commands_come_at_20_hz_and_wheel_speeds_at_50() -> None:
    _, samples = driven(1, 20)
    for kind, step in ((Pose, 0.05), (Command, 0.05), (Wheels, 0.02)):
        stamps = [sample.t for sample in samples if isinstance(sample, kind)]
        assert np.diff(stamps) == pytest.approx(step)
        assert len(stamps) == round(1.0 / step)
    stamps = [sample.t for sample in samples if isinstance(sample, Pose | Command | Wheels)]
    assert (np.diff(stamps) >= 0.0).all()


def test_the_same_seed_gives_the_same_drive_and_another_one_another() -> None:
    first, samples = driven(1, 20)
    again, same = driven(1, 20)
    other, different = driven(2, 20)
    assert samples == same
    assert np.array_equal(first.trace.xy, again.trace.xy)
    assert samples != different
    assert not np.array_equal(first.trace.xy, other.trace.xy)


def test_measured_poses_lie_about_the_true_ones() -> None:
    drive, samples = driven(1, 40)
    measured = np.array([(s.x, s.y) for s in samples if isinstance(s, Pose)])[1:]
    off = measured - drive.trace.xy[:-1]
    assert 0.005 < off.std() < 0.02


def test_another_model_gives_other_commands() -> None:
    drive, _ = driven(1, 40)
    adopted, _ = driven(1, 40)
    adopted.adopt([baseline_motion()])
    assert drive.advance()[0] != adopted.advance()[0]


@pytest.mark.slow
def test_the_floor_changes_where_the_course_says() -> None:
    drive, _ = driven(1, 10)
    while drive.floor == 0 and not drive.finished:
        drive.advance()
    trace = drive.trace
    assert drive.floor == 1
    assert trace.xy[trace.floor == 0, 0].max() < COURSE.changes[0] <= trace.xy[-1, 0]
    assert drive.course.floors[drive.floor] == FLOORS[1]
    assert not drive.arrived
