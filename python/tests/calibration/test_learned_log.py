# SPDX-License-Identifier: Apache-2.0
"""A log pushed through the learner once: its history, its predictions, and nothing of the future in them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sample_logs import Drive, log_until, moved, simulated_run

from slipwise import _core
from slipwise.calibration import Settings
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import Keep, learn_log, learn_with, new_learner
from slipwise.calibration.learner import BASELINE, STRUCTURES
from slipwise.calibration.prepared_run import collect_windows, prepare_run
from slipwise.logs import Log

HORIZONS = (1.0, 2.0, 5.0)
KEEP = Keep(0.6)
SLIP = _core.named_basis("edd-2")
INPUTS = ("wheel", "command")


@cache
def log() -> Log:
    """Two runs on one clock."""
    drive = Drive(seconds=50.0, basis=SLIP, alpha=(-0.1, -0.3), lag=0.2, delay=0.15)
    first = simulated_run(replace(drive, name="first"))
    second = simulated_run(replace(drive, seed=2, seconds=30.0, name="second"))
    return Log(runs=(first, moved(second, 60.0)))


def learned(log: Log, input_name: str, settings: Settings | None = None, keep: Keep | None = None) -> Learned:
    return learn_log(prepare_run(log, input_name), settings or Settings(), HORIZONS, keep=keep)


@cache
def whole(input_name: str) -> Learned:
    return learned(log(), input_name, keep=KEEP)


@pytest.mark.parametrize("input_name", INPUTS)
def test_the_history_has_a_row_for_each_segment_in_the_order_of_time(input_name: str) -> None:
    found = whole(input_name)
    history = found.history
    assert history is not None
    drive, settings = prepare_run(log(), input_name), Settings()
    rules = replace(settings.rules(), whole_frames=True)
    segments = collect_windows(drive, settings.segment_length(input_name), rules)
    assert len(segments) == len(history.t)
    assert np.array_equal(history.t, segments.end)
    assert np.array_equal(history.run, segments.position)
    assert history.mean.shape == history.std.shape == (len(history.t), len(history.names))
    assert np.allclose(history.basis_weight[-1].sum(), 1.0)
    assert history.bases == found.bases
    assert history.structures == STRUCTURES
    assert history.structure_weight is not None
    assert np.allclose(history.structure_weight.sum(axis=1), 1.0)
    learner = new_learner([run.run for run in drive], input_name, settings, HORIZONS)
    learn_with(learner, drive, HORIZONS)
    assert learner.model().segments == len(segments)
    assert learner.model().seconds == pytest.approx(float((segments.end - segments.start).sum()))


@pytest.mark.parametrize("input_name", INPUTS)
def test_the_last_row_of_the_history_is_what_is_kept(input_name: str) -> None:
    found = whole(input_name)
    assert found.history is not None
    assert found.history.names == tuple(info.name for info in found.kept.motion.parameters)
    assert np.array_equal(found.history.mean[-1], found.kept.mean)
    assert np.allclose(found.history.std[-1], np.sqrt(np.diag(found.kept.covariance)), rtol=1e-9)


def test_without_keep_there_is_no_history_and_the_same_predictions() -> None:
    found = learned(log(), "wheel")
    assert found.history is None
    for one, other in zip(found.predictions, whole("wheel").predictions, strict=True):
        assert one.pose.tobytes() == other.pose.tobytes()
        assert one.covariance.tobytes() == other.covariance.tobytes()


def test_progress_grows_from_above_zero_to_one() -> None:
    said: list[float] = []
    learn_log(prepare_run(log(), "wheel"), Settings(), HORIZONS, progress=said.append)
    assert said == sorted(said)
    assert 0.0 < said[0] < 0.1
    assert said[-1] == 1.0


@pytest.mark.parametrize("input_name", INPUTS)
def test_predictions_are_of_the_segments_that_are_cut_for_other_methods(input_name: str) -> None:
    drive = prepare_run(log(), input_name)
    for p, baseline in zip(whole(input_name).predictions, whole(input_name).baseline, strict=True):
        targets = collect_windows(drive, p.horizon, Settings().rules())
        for one in (p, baseline):
            assert np.array_equal(one.t_start, targets.start)
            assert np.array_equal(one.t_end, targets.end)
            assert np.array_equal(one.measured, targets.measured)
            assert np.array_equal(one.run, targets.position)
        assert baseline.method == "none"
        assert p.position_error[len(p) // 2 :].mean() < 0.5 * baseline.position_error[len(p) // 2 :].mean()


def test_the_history_of_a_log_cut_off_is_the_beginning_of_the_history() -> None:
    part, history = learned(log_until(log(), 35.0), "wheel", keep=KEEP).history, whole("wheel").history
    assert part is not None
    assert history is not None
    count = len(part.t) - 1
    assert count > 20
    assert np.array_equal(part.t[:count], history.t[:count])
    assert part.basis_weight[:count].tobytes() == history.basis_weight[:count].tobytes()


def test_a_robot_that_obeys_is_left_to_the_baseline_and_slip_is_of_the_next_best() -> None:
    obeying = Log(runs=(simulated_run(Drive(seconds=120.0, slip_psd=(1e-8, 1e-8, 1e-8))),))
    found = learned(obeying, "wheel", keep=KEEP)
    assert found.kept.structure == BASELINE
    assert found.kept.motion.size == 0
    assert found.identifiable.structure != BASELINE
    assert found.identifiable.motion.size > 0
