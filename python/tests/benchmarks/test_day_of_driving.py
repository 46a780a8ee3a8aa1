# SPDX-License-Identifier: Apache-2.0
"""A few minutes of `benchmarks/day_of_driving.py`, and when memory counts as flat."""

from __future__ import annotations

import day_of_driving
import numpy as np
import pytest
from day_of_driving import Day, Sample
from driven_day import COMMANDS, DELAYS, LAGS, POSES, WHEELS, DrivenDay


def day(*megabytes: float) -> Day:
    """A day with a sample an hour."""
    samples = (Sample(3600.0 * (k + 1), round(1e6 * each), 1.0) for k, each in enumerate(megabytes))
    return Day(tuple(samples), ())


def test_pieces_of_a_day_go_on_where_the_last_ended() -> None:
    robot = DrivenDay(3)
    before, after = robot.next(60.0), robot.next(60.0)
    for name, rate in (("commands", COMMANDS), ("wheels", WHEELS), ("poses", POSES)):
        stamps = np.concatenate((getattr(before, name)[:, 0], getattr(after, name)[:, 0]))
        np.testing.assert_allclose(np.diff(stamps), 1.0 / rate, atol=1e-9)
    places = np.vstack((before.poses, after.poses))[:, 1:3]
    assert np.hypot(*np.diff(places, axis=0).T).max() < 0.3
    speeds = np.concatenate((before.wheels[:, 1], after.wheels[:, 1]))
    assert np.abs(np.diff(speeds)).max() < 0.4


def test_wheels_follow_commands_after_delay_and_lag() -> None:
    piece = DrivenDay(4).next(600.0)
    every = COMMANDS // WHEELS
    for channel, delay, lag in ((1, DELAYS[0], LAGS[0]), (3, DELAYS[1], LAGS[1])):
        asked, driven = piece.commands[::every, channel], piece.wheels[:, channel]
        step, late = 1.0 / WHEELS, round(delay * WHEELS)
        keep = np.exp(-step / lag)
        expected = keep * driven[late:-1] + (1.0 - keep) * asked[: len(asked) - late - 1]
        assert np.abs(driven[late + 1 :] - expected).mean() < 0.02


@pytest.mark.parametrize("name", ["command", "wheel"])
def test_a_short_drive_is_measured(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(day_of_driving, "EVERY", 60.0)
    found = day_of_driving.drive(0.05, name, lambda _what, _share: None)
    assert [s.until for s in found.samples] == [60.0, 120.0, 180.0]
    assert all(s.resident > 1e6 for s in found.samples)
    assert all(s.per_push > 0.0 for s in found.samples)
    (hour,) = found.hours
    assert hour.pushes == 180 * (COMMANDS + WHEELS + POSES)
    assert hour.mean <= hour.most <= hour.longest


def test_memory_that_rises_to_the_end_is_not_flat() -> None:
    rising = day(*(100.0 + 0.1 * hour for hour in range(24)))
    assert rising.slope(day_of_driving.FULL)[0] == pytest.approx(1e5)
    assert rising.flat is False
    full = day(*(100.0 + min(hour, 5) for hour in range(24)))
    assert full.slope(day_of_driving.FIRST)[0] > 0.0
    assert full.flat is True
    assert day(100.0, 101.0).flat is None
