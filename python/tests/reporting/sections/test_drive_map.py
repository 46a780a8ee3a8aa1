# SPDX-License-Identifier: Apache-2.0
"""The maps of the drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of
from reporting.synthetic_results import make_results

from slipwise.logs.log import Log
from slipwise.reporting.chosen_windows import MOST_WINDOWS
from slipwise.reporting.sections.paths import PathsSection


def _maps(html: str) -> list[str]:
    return [name for name in figures_of(html) if name.startswith("figure-map")]


def test_map_has_equal_axes_and_starts_at_the_first_pose() -> None:
    figure = figures_of(PathsSection().html(contents_of(make_results())))["figure-map-1"]
    assert figure["layout"]["yaxis"]["scaleanchor"] == "x"
    assert (figure["data"][0]["x"][0], figure["data"][0]["y"][0]) == (0, 0)


def test_starts_of_the_shown_paths_are_marked_by_their_numbers() -> None:
    figure = figures_of(PathsSection().html(contents_of(make_results())))["figure-map-1"]
    numbers = [str(n) for n in range(1, MOST_WINDOWS + 1)]
    assert figure["data"][1]["text"] == numbers
    assert [note["text"] for note in figure["layout"]["annotations"]] == numbers


def test_every_run_and_frame_has_a_map_of_its_own() -> None:
    results = make_results(runs=2)
    first = results.log.runs[0]
    frame = np.repeat(np.array([0, 1]), len(first.poses) // 2)
    split = replace(first, poses=replace(first.poses, frame=frame))
    html = PathsSection().html(contents_of(replace(results, log=Log(runs=(split, results.log.runs[1])))))
    assert _maps(html) == ["figure-map-1", "figure-map-2", "figure-map-3"]
    assert "field 0, frame 1" in html


def test_many_drives_show_those_with_most_paths_and_say_so() -> None:
    html = PathsSection().html(contents_of(make_results(runs=8)))
    assert len(_maps(html)) == 6
    assert "Of 8 drives the 6 with the most paths are shown" in html


def test_far_away_poses_keep_their_shape() -> None:
    results = make_results()
    run = results.log.runs[0]
    far = replace(run, poses=replace(run.poses, x=run.poses.x + 5.4e6))
    near, moved = (
        figures_of(PathsSection().html(contents_of(replace(results, log=Log(runs=(r,))))))["figure-map-1"]
        for r in (run, far)
    )
    assert np.allclose(near["data"][0]["x"], moved["data"][0]["x"], atol=1e-4)
