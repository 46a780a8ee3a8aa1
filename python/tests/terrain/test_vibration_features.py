# SPDX-License-Identifier: Apache-2.0
"""Log powers in bands say at which frequency which axis shakes, and how much."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from slipwise.terrain.features import vibration_features, vibration_names

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


@pytest.mark.parametrize("rate", [100.0, 99.6, 40.0])
def test_they_are_those_of_a_fast_fourier_transform(rate: float) -> None:
    values = np.random.default_rng(2).standard_normal((int(5 * rate), 6)) + 3.0
    length = round(rate)
    window, centred = np.hanning(length)[:, None], values - values.mean(axis=0)
    starts = range(0, len(values) - length + 1, length // 2)
    spectra = [np.abs(np.fft.rfft(centred[at : at + length] * window, axis=0)) ** 2 for at in starts]
    power = np.mean(spectra, axis=0) / (window**2).sum()
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    edges = [edge for edge in (0.5, 2, 4, 6, 8, 11, 14, 18, 23, 29, 36, 43, 50) if edge <= rate / 2 * 1.01]
    bands = [power[(frequency >= low) & (frequency < high)].mean(axis=0) for low, high in pairwise(edges)]
    expected = np.log(np.stack(bands, axis=1) + 1e-9).ravel()
    np.testing.assert_allclose(vibration_features(values, rate), expected, rtol=1e-10)


def test_less_than_a_second_is_refused() -> None:
    with pytest.raises(ValueError, match="a second or more"):
        vibration_features(np.zeros((99, 6)), RATE)
