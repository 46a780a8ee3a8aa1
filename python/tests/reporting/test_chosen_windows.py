# SPDX-License-Identifier: Apache-2.0
"""The choice of windows to show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of
from reporting.synthetic_results import make_results

from slipwise.reporting.chosen_windows import MOST_WINDOWS, choose_windows


def test_chosen_windows_are_scored_ones_each_once() -> None:
    contents = contents_of(make_results(runs=3))
    chosen = choose_windows(contents)
    predictions = contents.predictions("auto", 5.0)
    assert predictions is not None
    assert [window.number for window in chosen] == list(range(1, MOST_WINDOWS + 1))
    rows = [window.row for window in chosen]
    assert len(set(rows)) == MOST_WINDOWS
    assert min(rows) >= len(predictions) // 2


def test_chosen_motions_differ_more_than_the_first_ones() -> None:
    contents = contents_of(make_results(runs=3))
    predictions = contents.predictions("auto", 5.0)
    assert predictions is not None

    def closest(rows: list[int]) -> float:
        ends = predictions.measured[rows]
        gaps = np.linalg.norm(ends[:, None] - ends[None], axis=2) + 1e9 * np.eye(len(rows))
        return float(gaps.min())

    half = len(predictions) // 2
    chosen = [window.row for window in choose_windows(contents)]
    assert closest(chosen) > closest(list(range(half, half + MOST_WINDOWS)))


def test_single_window_is_chosen_and_none_gives_none() -> None:
    results = make_results()
    part = next(p for p in results.evaluation.predictions if p.method == "auto" and p.horizon == 5.0)
    arrays = {
        name: getattr(part, name)[:1]
        for name in part.__dataclass_fields__
        if name not in ("method", "horizon")
    }
    one = replace(results.evaluation, predictions=(replace(part, **arrays),))
    assert [w.row for w in choose_windows(contents_of(replace(results, evaluation=one)))] == [0]
    none = replace(results.evaluation, predictions=())
    assert choose_windows(contents_of(replace(results, evaluation=none))) == []
