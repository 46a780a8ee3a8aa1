# SPDX-License-Identifier: Apache-2.0
"""Log powers in bands say at which frequency which axis shakes, and how much."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.vibration_features import vibration_features, vibration_names

RATE = 100.0


def tone(frequency: float, axis: int, seconds: float = 5.0) -> np.ndarray:
    t = np.arange(0.0, seconds, 1.0 / RATE)
    values = np.random.default_rng(0).standard_normal((len(t), 6)) * 1e-3
    values[:, axis] += np.sin(2.0 * np.pi * frequency * t)
    return values


@pytest.mark.parametrize(("frequency", "axis", "name"), [(5.0, 0, "wx_4_6_hz"), (25.0, 5, "az_23_29_hz")])
def test_a_tone_shows_in_its_band_of_its_axis(frequency: float, axis: int, name: str) -> None:
    features = vibration_features(tone(frequency, axis), RATE)
    assert vibration_names(RATE)[int(features.argmax())] == name


def test_twice_the_amplitude_adds_log_four() -> None:
    values = np.random.default_rng(1).standard_normal((500, 6))
    difference = vibration_features(2.0 * values, RATE) - vibration_features(values, RATE)
    np.testing.assert_allclose(difference, np.log(4.0), atol=1e-6)


def test_a_constant_offset_changes_nothing() -> None:
    values = np.random.default_rng(1).standard_normal((500, 6))
    shifted = values + np.array([0.0, 0.0, 0.0, 1.0, 2.0, 9.8])
    np.testing.assert_allclose(vibration_features(shifted, RATE), vibration_features(values, RATE), atol=1e-9)


def test_silence_is_finite() -> None:
    assert np.isfinite(vibration_features(np.zeros((100, 6)), RATE)).all()


def test_there_is_a_number_for_each_name_and_none_above_half_the_rate() -> None:
    assert len(vibration_features(np.zeros((50, 6)), 50.0)) == len(vibration_names(50.0)) == 6 * 8
    assert vibration_names(0.0) == []
