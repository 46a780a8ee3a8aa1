# SPDX-License-Identifier: Apache-2.0
"""How late a gyro beside poses is, from simulated drives and from real logs whose gyro is shifted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slipwise.calibration import calibrate
from slipwise.calibration.gyro_clock import gyro_clock
from slipwise.logs import Poses, Run, open_log

LATE, SCALE = 0.07, 1.03


def turning(seed: int, rate: float = 0.8) -> Run:
    """Return poses at 10 Hz and a gyro at 100 Hz with a bias, later and larger than it should be."""
    random, step = np.random.default_rng(seed), 0.01
    t = np.arange(0.0, 150.0, step)
    omega = np.convolve(np.repeat(random.uniform(-rate, rate, 75), 200), np.full(40, 1.0 / 40.0), "same")
    yaw = np.append(0.0, np.cumsum(0.5 * (omega[1:] + omega[:-1]) * step))[::10]
    zero = np.zeros(len(yaw))
    measured = np.angle(np.exp(1j * (yaw + random.normal(0.0, 0.005, len(yaw)))))
    poses = Poses(t=t[::10], x=zero, y=zero, yaw=measured, frame=np.zeros(len(yaw), np.int64))
    gyro = SCALE * omega + 0.01 + random.normal(0.0, 0.01, len(t))
    return Run("turning", None, None, poses, extra={"t": t + LATE, "gyro_z": gyro})


def test_intervals_of_many_drives_hold_the_lateness_and_the_scale() -> None:
    errors = []
    for seed in range(40):
        found = gyro_clock([turning(seed)])
        assert found is not None
        errors += [(found.late[0] - LATE) / found.late[1], (found.scale[0] - SCALE) / found.scale[1]]
        assert found.late[1] < 0.005
        assert found.scale[1] < 0.005
    assert 0.8 <= np.mean(np.abs(errors) < 1.645) <= 0.98
    assert "stamped 0.0" in found.sentence()
    assert "times as far" in found.sentence()


def test_a_robot_that_does_not_turn_tells_nothing() -> None:
    assert gyro_clock([turning(1, rate=0.0)]) is None


@pytest.mark.parametrize("name", ["husky/tile_deflated_tyres", "warthog/grass_7_29_14h46s15"])
def test_a_gyro_of_a_real_log_that_is_shifted_is_later_by_that(name: str, real_log_dir: Path) -> None:
    log = open_log(real_log_dir / f"{name}.csv.gz")
    runs = [replace(run, extra={**run.extra, "t": run.extra["t"] + 0.1}) for run in log.runs]
    found, shifted = gyro_clock(log.runs), gyro_clock(runs)
    assert found is not None
    assert shifted is not None
    assert shifted.late[0] - found.late[0] == pytest.approx(0.1, abs=3.0 * found.late[1])
    assert shifted.scale[0] == pytest.approx(found.scale[0], abs=found.scale[1])


def test_calibrate_says_it(real_log_dir: Path) -> None:
    log = open_log(real_log_dir / "warthog/grass_7_29_14h46s15.csv.gz")
    notes = calibrate(log, input="wheel").notes
    assert any(note.startswith("the gyro is stamped 0.34") for note in notes), notes
