# SPDX-License-Identifier: Apache-2.0
"""Poses that were interpolated are found with how many say what one does; measured and exact ones are not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contradictory_logs import SKID_STEERED, with_poses
from sample_logs import Drive, simulated_log

from slipwise.calibration import calibrate
from slipwise.logs import Inputs, Log, Poses, Run, open_log
from slipwise.logs.findings.filled_poses import FilledPoses
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.seen import WholeLog
from slipwise.logs.log import Floats
from slipwise.models.slip_words import slip_gains

DRIVE = replace(SKID_STEERED, seconds=120.0, speeds=(0.2, 1.2), pose_std=(0.03, 0.01))
EXACT = {"pose_std": (0.0, 0.0), "slip_psd": (0.0, 0.0, 0.0)}


def filled(log: Log, count: int, digits: int = 12, every: int = 20) -> Log:
    """Put `count` poses on straight lines in place of each, between every 20th pose [1 s]."""

    def change(p: Poses) -> Poses:
        knots = p.select(np.arange(0, len(p), every))
        t = np.linspace(knots.t[0], knots.t[-1], (len(knots) - 1) * count + 1)
        columns = (knots.x, knots.y, np.unwrap(knots.yaw))
        x, y, yaw = (np.round(np.interp(t, knots.t, column), digits) for column in columns)
        return replace(p, t=t, x=x, y=y, yaw=yaw, frame=np.zeros(len(t), np.int64))

    return with_poses(log, change)


def thinned(log: Log) -> Log:
    return with_poses(log, lambda p: p.select(np.arange(0, len(p), 20)))


def positions(log: Log) -> Log:
    return with_poses(log, lambda p: replace(p, course=True))


def found_in(log: Log) -> Finding | None:
    return FilledPoses().look_at(WholeLog(log, "wheel"))


@pytest.mark.parametrize("count", [5, 10, 20, 50])
@pytest.mark.parametrize("digits", [12, 5, 4])
def test_filled_poses_are_found_with_how_many_there_are(count: int, digits: int) -> None:
    if (count, digits) == (50, 4):  # steps of 1.4 cm, to 0.1 mm: rounding bends the path as much as turns do
        return
    log = filled(simulated_log(DRIVE), count, digits)
    for each in (log, positions(log)):
        found = found_in(each)
        assert found is not None
        assert found.spoils
        assert found.evidence == count
        assert "a corner every 1 s" in found.sentence


def test_no_model_of_filled_poses_is_good() -> None:
    """It lags by 0.3 s, as the robot does not; of the poses as they were measured it does not."""
    log = simulated_log(replace(DRIVE, seconds=240.0))
    later = with_poses(filled(log, 20), lambda p: p.select(np.arange(7, len(p))))  # corners between windows
    result = calibrate(later, input="wheel")
    assert not result.verdict.good
    assert "poses were interpolated: their path has a corner every 1 s" in str(result.verdict)
    rows = {row.name: row for row in result.model.table.rows}
    assert np.exp(rows["log_time_constant_omega"].value) > 0.2
    measured = calibrate(thinned(log), input="wheel")
    turns = slip_gains(measured.model).yaw_rate
    assert measured.verdict.good
    assert abs(turns.value - 0.6) < 2.0 * turns.std


def test_poses_between_those_of_4_hz_are_said_only() -> None:
    found = found_in(filled(simulated_log(DRIVE), 5, every=5))
    assert found is not None
    assert found.reserves
    assert not found.spoils


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_measured_and_exact_poses_are_not_found(seed: int) -> None:
    for drive in (
        DRIVE,
        replace(DRIVE, **EXACT),
        Drive(),
        Drive(**EXACT),
        Drive(yaw_rates=(0.0, 0.0), **EXACT),
    ):
        for digits in (12, 4, 3, 2):
            log = with_poses(
                simulated_log(replace(drive, seed=seed)),
                lambda p, to=digits: replace(
                    p, x=np.round(p.x, to), y=np.round(p.y, to), yaw=np.round(p.yaw, to)
                ),
            )
            for each in (log, positions(log), thinned(log)):
                assert found_in(each) is None


def exact(v: Floats, omega: Floats, course: Floats) -> Log:
    """Exact poses of commands that are held for 1 s, of a robot that answers at once."""
    t = 0.05 * np.arange(len(v))
    yaw = np.concatenate(([0.0], np.cumsum(0.05 * omega[:-1])))
    along = yaw + 0.025 * omega + course
    x, y = (np.concatenate(([0.0], np.cumsum(0.05 * v * of(along))[:-1])) for of in (np.cos, np.sin))
    poses = Poses(t=t, x=x, y=y, yaw=yaw, frame=np.zeros(len(t), np.int64))
    return Log(runs=(Run("a", None, Inputs(t=t, v=v, vy=0.0 * v, omega=omega), poses),))


def test_exact_drives_whose_commands_change_every_second_are_not_found() -> None:
    rng = np.random.default_rng(4)
    v, omega = (np.repeat(rng.uniform(low, high, 100), 20) for low, high in ((0.3, 1.0), (-0.5, 0.5)))
    still = np.zeros(len(v))
    for each in (exact(v, omega, still), exact(v, still, still), exact(0.0 * v + 0.5, still, still)):
        assert found_in(each) is None
        assert found_in(positions(each)) is None
    sideways = np.repeat(rng.uniform(-1.0, 1.0, 100), 20)
    assert found_in(exact(v, still, sideways)) is None  # a vehicle of wheels that drive to all sides


@pytest.mark.slow
def test_no_poses_of_a_real_log_were_filled(real_log_dir: Path) -> None:
    for path in sorted(real_log_dir.glob("*/*.csv.gz")):
        log = open_log(path)
        assert found_in(log) is None, path.name
        assert found_in(positions(log)) is None, path.name
