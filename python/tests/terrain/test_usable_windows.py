# SPDX-License-Identifier: Apache-2.0
"""Windows that cannot be trained on are left out and named; runs are dealt whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_terrain import made_recording, made_recordings

from slipwise.errors import LogError
from slipwise.terrain import Windows, cut_windows
from slipwise.terrain.train import folds_of, usable_windows
from slipwise.terrain.windows import cutting_of


def windows_of(recordings: list) -> Windows:  # type: ignore[type-arg]
    return cut_windows(recordings, cutting_of(recordings, 2.0), step=2.0)


def test_a_surface_of_one_run_is_left_out_and_named() -> None:
    recordings = [*made_recordings(runs=2), made_recording("lonely", "grass")]
    recordings[-1] = replace(
        recordings[-1], labels=np.full(len(recordings[-1].label_t), "moss", dtype=object)
    )
    kept, surfaces, notes = usable_windows(windows_of(recordings))
    assert surfaces == ("grass", "gravel", "tiles")
    assert set(kept.label) == set(surfaces)
    assert notes == ["left out: moss, which has one run; 2 at least are needed"]


def test_a_sensor_that_one_surface_lacks_is_not_used() -> None:
    recordings = made_recordings(runs=2)
    recordings[:2] = [replace(recording, imu=None) for recording in recordings[:2]]
    kept, _, notes = usable_windows(windows_of(recordings))
    assert not kept.has_vibration.any()
    assert kept.has_current.all()
    assert notes == ["left out: vibration, which grass has in 0 runs"]


def test_too_few_surfaces_are_refused() -> None:
    with pytest.raises(LogError, match="1 surfaces with 2 runs or more; two are needed"):
        usable_windows(windows_of([made_recording("a", "grass"), made_recording("b", "grass")]))


def test_a_surface_called_unknown_is_refused() -> None:
    recording = made_recording("a", "grass")
    recording = replace(recording, labels=np.full(len(recording.labels), "unknown", dtype=object))
    with pytest.raises(LogError, match="a surface is called unknown"):
        usable_windows(windows_of([recording]))


@pytest.mark.parametrize("runs", [2, 3, 7])
def test_folds_hold_whole_runs_and_leave_every_surface_in_the_rest(runs: int) -> None:
    windows, surfaces, _ = usable_windows(windows_of(made_recordings(runs=runs, seconds=6.0)))
    folds = folds_of(windows, surfaces, 0)
    assert len(folds) == min(runs, 5)
    assert np.sum(folds, axis=0).tolist() == [1] * len(windows)
    for fold in folds:
        assert not set(windows.run[fold]) & set(windows.run[~fold])
        assert set(windows.label[~fold]) == set(surfaces)


def test_a_run_over_all_surfaces_cannot_be_left_out() -> None:
    windows, surfaces, _ = usable_windows(windows_of(made_recordings(runs=2, seconds=6.0)))
    two_runs = replace(windows, run=np.array([run[-1] for run in windows.run], dtype=object))
    one_run = replace(two_runs, run=np.where(two_runs.label == "tiles", "0", two_runs.run).astype(object))
    with pytest.raises(LogError, match="without one part of the runs there is no tiles"):
        folds_of(one_run, surfaces, 0)
