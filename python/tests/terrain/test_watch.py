# SPDX-License-Identifier: Apache-2.0
"""What is pushed sample by sample is answered as the whole log is."""

from __future__ import annotations

import heapq

import numpy as np
import pytest
from sample_terrain import made_recordings

from slipwise.errors import SettingsError
from slipwise.terrain import TerrainWatch, cut_windows, train
from slipwise.terrain.train import Training


@pytest.fixture(scope="module")
def training() -> Training:
    pytest.importorskip("sklearn")
    return train(made_recordings(runs=3, seconds=12.0), seconds=2.0)


@pytest.mark.slow
def test_windows_are_answered_as_those_of_a_log(training: Training) -> None:
    classifier = training.classifier
    for recording in made_recordings(runs=1, seconds=9.0)[:2]:
        assert recording.imu is not None
        assert recording.drive is not None
        watch = TerrainWatch(classifier, step=1.0)
        imu = [(t, 0, row) for t, row in zip(recording.imu.t, recording.imu.values.tolist(), strict=True)]
        drive = [
            (t, 1, row) for t, row in zip(recording.drive.t, recording.drive.values.tolist(), strict=True)
        ]
        for t, kind, row in heapq.merge(imu, drive):
            (watch.push_currents if kind else watch.push_imu)(t, row)
        found = watch.answers()
        windows = cut_windows([recording], classifier.cutting, step=1.0)
        expected = classifier.answer(windows)
        assert len(found) >= 5
        for k, each in enumerate(found):
            assert each.start == pytest.approx(windows.start[k])
            np.testing.assert_allclose(list(each.probability.values()), expected.probability[k], atol=1e-9)
            assert each.unknown == pytest.approx(expected.unknown[k])


@pytest.mark.slow
def test_bad_samples_are_left_out_and_a_bad_step_is_refused(training: Training) -> None:
    watch = TerrainWatch(training.classifier)
    watch.push_imu(0.0, [float("nan")] * 6)
    assert watch.left_out == 1
    with pytest.raises(SettingsError, match="positive and finite"):
        TerrainWatch(training.classifier, step=0.0)
