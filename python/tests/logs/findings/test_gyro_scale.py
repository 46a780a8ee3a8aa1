# SPDX-License-Identifier: Apache-2.0
"""A gyro whose scale is wrong is found beside positions, with the scale, and no sound one is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from sample_positions import ANTENNA, BASIS, SECONDS, SETTINGS, SLIP, commands

from slipwise.calibration import calibrate
from slipwise.logs import Log, Run, open_log
from slipwise.logs.findings.finding import Finding
from slipwise.logs.findings.gyro_scale import GyroLate, GyroScale, gyro_scale
from slipwise.logs.findings.seen import WholeLog
from slipwise_sim.known_robot import KnownRobot, known_run

LATE = 0.2  # s


def drive(scale: float, seed: int = 1, *, std: float = 0.01) -> Run:
    """Return positions of an antenna off centre on a robot that slips, and a late gyro with a bias."""
    random = np.random.default_rng(seed)
    robot = KnownRobot(
        lag=(0.2, 0.3), delay=(0.1, 0.15), basis=BASIS, slip=SLIP, sensor=ANTENNA, pose_std=(std, 0.0)
    )
    run = known_run(robot, commands(random), (0.0, SECONDS), random=random)
    t, yaw = run.poses.t, np.unwrap(run.poses.yaw)
    rate = scale * np.diff(yaw) / np.diff(t) + 0.012 + 0.01 * random.standard_normal(len(t) - 1)
    extra = {"t": 0.5 * (t[1:] + t[:-1]) + LATE, "gyro_z": rate}
    return replace(run, poses=replace(run.poses, course=True), extra=extra)


def found_in(*runs: Run) -> Finding | None:
    return GyroScale().look_at(WholeLog(Log(runs), "wheel"))


@pytest.mark.parametrize("scale", [0.7, 0.95, 1.05, 1.3])
def test_another_scale_is_said_with_its_deviation_and_reserves_the_model(scale: float) -> None:
    found = found_in(drive(scale))
    assert found is not None
    assert (found.spoils, found.reserves) == (False, True)
    assert found.evidence == pytest.approx(scale, abs=0.02)
    assert f"the gyro turns {scale:.1f}"[:-1] in found.sentence
    assert "Divide gyro_z by " in found.advice[0]


def test_intervals_of_many_drives_hold_the_scale_and_how_late_it_is() -> None:
    errors = []
    for seed in range(12):
        found = gyro_scale([drive(1.1, seed, std=0.02)])
        assert found is not None
        assert found.std < 0.02
        assert found.late == pytest.approx(LATE, abs=0.05)
        errors.append((found.scale - 1.1) / found.std)
    assert np.max(np.abs(errors)) < 3.0
    assert np.mean(np.abs(errors) < 1.0) > 0.5


def test_a_gyro_of_the_right_scale_and_a_drive_that_does_not_tell_say_nothing() -> None:
    assert found_in(drive(1.0)) is None
    run = drive(1.1)
    still = replace(run, poses=replace(run.poses, x=0.0 * run.poses.x, y=0.0 * run.poses.y))
    assert found_in(still) is None
    assert found_in(replace(run, extra={})) is None
    assert found_in(replace(run, poses=replace(run.poses, course=False))) is None  # it is not learned from


def test_calibrate_reserves_its_verdict() -> None:
    verdict = calibrate(Log((drive(1.1),)), input="wheel", settings=SETTINGS).verdict
    assert verdict.good
    assert any(each.startswith("The gyro turns 1.") for each in verdict.reservations)


@pytest.mark.slow
def test_no_gyro_of_a_real_log_without_its_headings_is_said_to_turn_otherwise(
    real_log_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = 0
    for path in sorted(
        [*real_log_dir.glob("*/*.csv.gz"), *real_log_dir.parent.glob("vehicles/warthog*.csv.gz")]
    ):
        log = open_log(path)
        runs = [replace(run, poses=replace(run.poses, course=True)) for run in log.runs]
        scale = gyro_scale(runs)
        known += scale is not None
        monkeypatch.setattr(f"{GyroScale.__module__}.gyro_scale", lambda _, scale=scale: scale)  # once
        assert found_in(*runs) is None, path.name
    assert known >= 6


@pytest.mark.parametrize("scale", [0.25, 0.5, 4.0])
def test_a_gyro_of_another_range_spoils_the_model(scale: float) -> None:
    found = found_in(drive(scale))
    assert found is not None
    assert found.spoils
    assert found.evidence == pytest.approx(scale, rel=0.03)


def test_turns_that_fit_the_track_at_no_scale_are_no_scale() -> None:
    run = drive(1.0)
    found = found_in(replace(run, extra={**run.extra, "gyro_z": run.extra["gyro_z"] + 0.5}))
    assert found is not None
    assert found.spoils
    assert "at no scale" in found.sentence


@pytest.mark.parametrize(("late", "spoils"), [(0.05, None), (0.2, False), (0.5, True)])
def test_a_late_gyro_is_said_with_how_late_it_is(late: float, *, spoils: bool | None) -> None:
    run = drive(1.0)
    later = replace(run, extra={**run.extra, "t": run.extra["t"] - LATE + late})
    found = GyroLate().look_at(WholeLog(Log((later,)), "wheel"))
    assert (None if found is None else found.spoils) == spoils
    assert found is None or found.evidence == pytest.approx(late, abs=0.05)
