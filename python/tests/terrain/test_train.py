# SPDX-License-Identifier: Apache-2.0
"""Training tells surfaces apart on drives that it has not seen, and knows what it has never felt."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from sample_terrain import made_recording, made_recordings

from slipwise.errors import SettingsError
from slipwise.terrain import UNKNOWN, Recording, Training, cut_windows, train

pytestmark = pytest.mark.skipif(find_spec("sklearn") is None, reason="training needs scikit-learn")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def training() -> Training:
    return train(made_recordings(runs=4), seconds=2.0)


def windows_of(training: Training, recordings: list[Recording]) -> tuple[np.ndarray, np.ndarray]:
    windows = cut_windows(recordings, training.classifier.cutting, step=2.0)
    answer = training.classifier.answer(windows)
    return training.classifier.labels(answer, 0.0), answer.kind


def test_new_drives_are_named_rightly_with_each_set_of_sensors(training: Training) -> None:
    fresh = made_recordings(runs=2, seed=1)
    for kind, recordings in {
        "both": fresh,
        "vibration": [replace(recording, drive=None) for recording in fresh],
        "current": [replace(recording, imu=None) for recording in fresh],
    }.items():
        labels, kinds = windows_of(training, recordings)
        assert set(kinds) == {kind}
        truth = np.repeat([recording.run.split("_")[0] for recording in recordings], 10)
        assert (labels == truth).mean() > (0.8 if kind == "current" else 0.99)


def test_scores_are_of_every_set_of_sensors_on_runs_left_out(training: Training) -> None:
    assert set(training.scores) == {"vibration", "current", "both"}
    assert training.scores["both"].accuracy > 0.99
    assert training.scores["both"].calibration_error < 0.05
    assert training.runs == {"grass": 4, "gravel": 4, "tiles": 4}


def test_a_surface_of_another_frequency_is_unknown(training: Training) -> None:
    strange = made_recording("new", "grass", seed=3)
    assert strange.imu is not None
    t = strange.imu.t
    shaking = np.sin(2.0 * np.pi * 12.0 * t[:, None] + np.arange(6.0))
    noise = 0.2 * np.random.default_rng(0).standard_normal(shaking.shape)
    strange = replace(strange, imu=replace(strange.imu, values=shaking + noise), drive=None)
    windows = cut_windows([strange], training.classifier.cutting, step=2.0)
    answer = training.classifier.answer(windows)
    assert (training.classifier.labels(answer, 0.8) == UNKNOWN).all()
    known = cut_windows(made_recordings(runs=1, seed=2), training.classifier.cutting, step=2.0)
    answer = training.classifier.answer(known)
    assert (training.classifier.labels(answer, 0.8) == UNKNOWN).mean() < 0.2


def test_the_same_seed_trains_the_same() -> None:
    recordings = made_recordings(runs=2, seconds=8.0)
    first, second = (train(recordings, seconds=2.0, seed=5) for _ in range(2))
    assert first.scores == second.scores
    assert first.classifier.pools == second.classifier.pools


def test_of_two_surfaces_none_is_called_unknown_and_a_note_says_so() -> None:
    recordings = [each for each in made_recordings(runs=2) if each.labels[0] != "tiles"]
    made = train(recordings, seconds=2.0)
    assert made.notes == (
        "two surfaces: what an unknown one is like cannot be learned, so none is called unknown",
    )
    windows = cut_windows(recordings, made.classifier.cutting, step=2.0)
    labels = made.classifier.labels(made.classifier.answer(windows), 0.8)
    assert (labels == windows.label).all()


def test_progress_rises_to_one() -> None:
    told: list[float] = []
    train(made_recordings(runs=2, seconds=8.0), seconds=2.0, progress=lambda _what, share: told.append(share))
    assert told == sorted(told)
    assert 0.0 < told[0] < told[-1] <= 1.0


@pytest.mark.parametrize("seconds", [0.5, 6.0, float("nan")])
def test_windows_of_other_lengths_are_refused(seconds: float) -> None:
    with pytest.raises(SettingsError, match=r"windows of .* s"):
        train(made_recordings(runs=2), seconds=seconds)


@pytest.mark.parametrize("left_out", ["imu", "drive"])
def test_one_sensor_alone_is_trained_with(left_out: str) -> None:
    recordings = [replace(each, **{left_out: None}) for each in made_recordings(seconds=12.0)]
    training = train(recordings, seconds=1.0)
    (kind,) = training.scores
    assert kind == {"imu": "current", "drive": "vibration"}[left_out]
    assert training.scores[kind].accuracy > 0.9
