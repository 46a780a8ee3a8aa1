# SPDX-License-Identifier: Apache-2.0
"""Measured, plain and predicted paths of a window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of
from reporting.synthetic_results import make_results, without_history

from slipwise.logs.log import Log
from slipwise.reporting.chosen_windows import MOST_WINDOWS, choose_windows
from slipwise.reporting.window_paths import window_paths


def test_paths_start_at_the_robot_and_the_learned_one_ends_near_the_measured_one() -> None:
    contents = contents_of(make_results())
    paths = window_paths(contents, choose_windows(contents))
    assert len(paths) == MOST_WINDOWS
    for path in paths.values():
        assert np.allclose(path.measured[0], 0.0)
        assert np.allclose(path.predicted[0], 0.0)
        assert path.causal
    off = [np.hypot(*(path.predicted[-1] - path.measured[-1])[:2]) for path in paths.values()]
    plain = [np.hypot(*(path.plain[-1] - path.measured[-1])[:2]) for path in paths.values()]
    assert np.mean(off) < 0.1 * np.mean(plain)


def test_nothing_learned_after_the_start_changes_a_path() -> None:
    results = make_results()
    contents = contents_of(results)
    window = choose_windows(contents)[0]
    before = window_paths(contents, [window])[window]
    history = results.calibration.history
    assert history is not None
    later = history.t > window.t_start - 5.0
    changed = replace(history, mean=np.where(later[:, None], 9.0, history.mean))
    other = contents_of(replace(results, calibration=replace(results.calibration, history=changed)))
    assert np.array_equal(window_paths(other, [window])[window].predicted, before.predicted)


def test_batch_fit_draws_the_final_model_and_says_so() -> None:
    contents = contents_of(without_history(make_results()))
    paths = window_paths(contents, choose_windows(contents))
    assert not any(path.causal for path in paths.values())


def test_window_without_inputs_or_poses_is_left_out() -> None:
    results = make_results()
    chosen = choose_windows(contents_of(results))
    no_inputs = Log(runs=(replace(results.log.runs[0], commands=None),))
    assert window_paths(contents_of(replace(results, log=no_inputs)), chosen) == {}
    assert window_paths(contents_of(replace(results, log=Log(runs=()))), chosen) == {}
