# SPDX-License-Identifier: Apache-2.0
"""Windows are cut where there are samples, at the rate of the training logs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_terrain import DRIVE_RATE, IMU_RATE, made_recording

from slipwise.errors import LogError
from slipwise.terrain import Stream, cut_windows
from slipwise.terrain.windows import cutting_of


def test_rates_are_those_of_the_recordings() -> None:
    cutting = cutting_of([made_recording("a", "grass")], 2.0)
    assert (cutting.imu_rate, cutting.drive_rate) == pytest.approx((IMU_RATE, DRIVE_RATE))


def test_windows_follow_each_other_and_have_both_sensors() -> None:
    recording = made_recording("a", "grass", seconds=10.0)
    windows = cut_windows([recording], cutting_of([recording], 2.0), step=2.0)
    assert windows.start.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert (windows.end - windows.start == 2.0).all()
    assert set(windows.label) == {"grass"}
    assert windows.has_vibration.all()
    assert windows.has_current.all()


def test_a_gap_leaves_out_the_sensor_and_not_the_window() -> None:
    recording = made_recording("a", "grass", seconds=10.0)
    assert recording.imu is not None
    kept = (recording.imu.t < 4.5) | (recording.imu.t > 5.5)
    broken = replace(recording, imu=Stream(recording.imu.t[kept], recording.imu.values[kept]))
    windows = cut_windows([broken], cutting_of([recording], 2.0), step=2.0)
    assert windows.has_vibration.tolist() == [True, True, False, True, True]
    assert windows.has_current.all()


def test_an_imu_that_ends_early_leaves_currents_alone() -> None:
    recording = made_recording("a", "grass", seconds=10.0)
    assert recording.imu is not None
    short = replace(recording, imu=Stream(recording.imu.t[:450], recording.imu.values[:450]))
    windows = cut_windows([short], cutting_of([recording], 2.0), step=2.0)
    assert windows.has_vibration.sum() == 2
    assert windows.has_current.sum() == 5


def test_samples_that_come_unevenly_give_nearly_the_same_numbers() -> None:
    recording = made_recording("a", "grass", seconds=6.0)
    assert recording.imu is not None
    rng = np.random.default_rng(0)
    t = recording.imu.t + rng.uniform(-5e-5, 5e-5, len(recording.imu.t))
    shaken = replace(recording, imu=Stream(t, recording.imu.values))
    cutting = cutting_of([recording], 2.0)
    even, uneven = (cut_windows([each], cutting, step=2.0) for each in (recording, shaken))
    assert np.abs(even.vibration[1:2] - uneven.vibration[1:2]).max() < 0.2


def test_another_rate_than_in_training_is_refused() -> None:
    recording = made_recording("a", "grass")
    cutting = replace(cutting_of([recording], 2.0), imu_rate=400.0)
    with pytest.raises(LogError, match=r"sampled at 100 Hz, in training at 400 Hz \(run a\): resample it"):
        cut_windows([recording], cutting, step=2.0)


def test_progress_ends_at_one() -> None:
    recording = made_recording("a", "grass", seconds=4.0)
    told: list[float] = []
    cut_windows([recording] * 2, cutting_of([recording], 2.0), step=2.0, progress=told.append)
    assert told == [0.5, 1.0]
