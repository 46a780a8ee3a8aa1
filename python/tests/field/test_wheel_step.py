# SPDX-License-Identifier: Apache-2.0
"""Wheel speeds are held or averaged over their period, which is no offset between clocks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from sample_field import field_drive, field_path, learned, noisy

from slipwise.calibration.inputs_seen import WheelStep
from slipwise.models.summary import summarise


def said_of(path: Path) -> str:
    result, _ = learned(path, "wheel")
    return str(summarise(result.model))


def test_half_a_period_of_the_wheels_is_no_offset_of_clocks() -> None:
    said = said_of(field_path("wheels_10hz.csv.gz"))
    assert "Poses come" not in said
    assert "Poses are stamped" not in said


@pytest.mark.slow
@pytest.mark.parametrize("period", [0.05, 0.2])
@pytest.mark.parametrize("mean", [False, True], ids=["samples", "means"])
@pytest.mark.parametrize("late", [0.0, 0.15])
def test_an_offset_is_said_where_it_is_one(tmp_path: Path, period: float, mean: bool, late: float) -> None:
    drive = field_drive(120.0)
    poses, rows = noisy(drive), []
    for k in drive.every(period):
        before = slice(max(k - round(period / 0.01), 0), k + 1)
        v, omega = drive.wheels[before].mean(axis=0) if mean else drive.wheels[k]
        rows.append((float(drive.t[k]), f"{v:.4f},{omega:.4f},,,"))
    for k in drive.every(0.1):
        x, y, yaw = poses[k]
        rows.append((float(drive.t[k]) + late + 0.001, f",,{x:.4f},{y:.4f},{yaw:.4f}"))
    lines = [f"{t:.4f},{rest}" for t, rest in sorted(rows)]
    (tmp_path / "a.csv").write_text("\n".join(["t,odo_v,odo_omega,x,y,yaw", *lines]) + "\n")
    words = said_of(tmp_path / "a.csv")
    assert "Wheel speeds are stamped" not in words
    if late > period:
        assert "later than wheel speeds" in words


def test_stamps_one_by_one_are_those_of_a_run() -> None:
    t = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.6, 200))
    one, whole = WheelStep(), WheelStep()
    for run in (t, t + 1000.0):
        for each in run.tolist():
            one.take(each)
        one.restart()
        whole.take_run(run)
    assert (one.total, one.count) == (whole.total, whole.count)
    assert one.seconds == whole.seconds > 0.0
