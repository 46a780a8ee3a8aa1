# SPDX-License-Identifier: Apache-2.0
"""Command scripts excite what they should, within limits, and are the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.errors import SettingsError
from slipwise_sim.drive import (
    CIRCLE_CURVATURES,
    CIRCLE_SPEEDS,
    DRIVES,
    TOP_REVERSE,
    TOP_SPEED,
    TOP_YAW_RATE,
    dull_drive,
    hold,
    thesis_drive,
)


def test_thesis_drive_visits_every_speed_and_curvature_to_both_sides() -> None:
    drive = thesis_drive(3, 300.0)
    on_circles = drive.t < 180.0
    driven = {
        (float(v), round(float(omega / v), 9))
        for v, omega in zip(drive.v[on_circles], drive.omega[on_circles], strict=True)
    }
    wanted = {(v, side * kappa) for v in CIRCLE_SPEEDS for kappa in CIRCLE_CURVATURES for side in (1, -1)}
    assert driven == wanted


def test_thesis_drive_stays_ten_seconds_on_each_circle() -> None:
    drive = thesis_drive(3, 300.0)
    circles = np.stack([drive.v, drive.omega], axis=-1)[:3600].reshape(18, 200, 2)
    assert np.array_equal(circles, np.broadcast_to(circles[:, :1], circles.shape))


def test_random_driving_has_turns_in_place_stops_and_reversals() -> None:
    drive = thesis_drive(0, 1200.0)
    late = drive.t > 0.6 * 1200.0
    v, omega = drive.v[late], drive.omega[late]
    assert np.sum((v == 0) & (np.abs(omega) >= 0.3)) > 200
    assert np.sum((v == 0) & (omega == 0)) > 100
    assert np.sum(v <= -0.3) > 200
    assert np.sum(v >= 0.3) > 2000


def test_commands_stay_within_the_limits(subtests: pytest.Subtests) -> None:
    for seed in range(5):
        with subtests.test(seed=seed):
            drive = thesis_drive(seed, 400.0)
            assert drive.v.max() <= TOP_SPEED
            assert drive.v.min() >= -TOP_REVERSE
            assert np.abs(drive.omega).max() <= TOP_YAW_RATE


def test_random_driving_is_smooth_and_joins_the_last_circle() -> None:
    drive = thesis_drive(1, 300.0)
    late = drive.t >= 180.0 - 0.051
    assert np.abs(np.diff(drive.v[late])).max() < 0.16
    assert np.abs(np.diff(drive.omega[late])).max() < 0.11


def test_same_seed_gives_the_same_drive_and_another_seed_another() -> None:
    first, second, other = thesis_drive(5, 60.0), thesis_drive(5, 60.0), thesis_drive(6, 60.0)
    assert first.v.tobytes() + first.omega.tobytes() == second.v.tobytes() + second.omega.tobytes()
    assert not np.array_equal(first.v, other.v)


def test_commands_come_at_20_hz_until_the_end(subtests: pytest.Subtests) -> None:
    for duration in [0.01, 0.05, 1.0, 20.0, 20.01]:
        for name in sorted(DRIVES):
            with subtests.test(duration=duration, name=name):
                drive = DRIVES[name](0, duration)
                assert drive.t[0] == 0
                assert drive.t[-1] < duration <= drive.t[-1] + 0.05 + 1e-9
                np.testing.assert_allclose(np.diff(drive.t), 0.05, atol=1e-12)


def test_short_drive_leaves_circles_out_rather_than_hurry() -> None:
    drive = thesis_drive(0, 30.0)
    circles = drive.v[drive.t < 18.0]
    assert len(np.flatnonzero(np.diff(circles))) <= 3


def test_dull_drive_is_straight_at_one_speed() -> None:
    drive = dull_drive(9, 10.0)
    assert set(drive.v.tolist()) == {1.0}
    assert not drive.omega.any()
    assert not drive.vy.any()


def test_hold_repeats_one_command() -> None:
    drive = hold(1, -0.5, 2.0)
    assert drive.v.tolist() == [1.0] * 40
    assert drive.omega.tolist() == [-0.5] * 40


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_duration_is_refused(duration: float) -> None:
    with pytest.raises(SettingsError, match="duration"):
        thesis_drive(0, duration)
