# SPDX-License-Identifier: Apache-2.0
"""The section of the paths."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from reporting.page_parts import contents_of, figures_of, text_of
from reporting.synthetic_results import make_results, without_history

from slipwise.logs.log import Run
from slipwise.reporting.chosen_windows import MOST_WINDOWS, choose_windows
from slipwise.reporting.sections.paths import PathsSection, typical_path
from slipwise.reporting.timeline import Timeline

NAMES = ["kinematic baseline", "measured", "slipwise"]


def test_each_chosen_window_shows_ellipse_plain_measured_and_predicted() -> None:
    contents = contents_of(make_results())
    html = typical_path(contents) + PathsSection().html(contents)
    figures = {name: f for name, f in figures_of(html).items() if name.startswith("figure-path")}
    assert len(figures) == MOST_WINDOWS
    for figure in figures.values():
        assert figure["data"][0]["fill"] == "toself"
        assert [trace["name"] for trace in figure["data"][1:4]] == NAMES
    assert "nothing measured later is in it" in text_of(html)


def test_arrow_head_points_along_the_heading() -> None:
    contents = contents_of(make_results())
    figure = figures_of(PathsSection().html(contents))["figure-path-1"]
    auto = contents.predictions("auto", 5.0)
    assert auto is not None
    end = figure["data"][-1]
    row = int(np.argmin(np.abs(auto.pose[:, 0] - end["x"][0]) + np.abs(auto.pose[:, 1] - end["y"][0])))
    expected = (90.0 - np.degrees(auto.pose[row, 2])) % 360.0
    assert abs(end["marker"]["angle"] - expected) < 0.1


def test_batch_fit_says_that_the_final_model_is_drawn() -> None:
    html = PathsSection().html(contents_of(without_history(make_results())))
    assert "use the final model" in text_of(html)


def test_covariance_that_is_none_leaves_the_ellipse_out() -> None:
    results = make_results()
    parts = tuple(
        replace(p, covariance=np.full_like(p.covariance, np.nan)) for p in results.evaluation.predictions
    )
    html = PathsSection().html(
        contents_of(replace(results, evaluation=replace(results.evaluation, predictions=parts)))
    )
    assert [trace["name"] for trace in figures_of(html)["figure-path-1"]["data"][:3]] == NAMES


def test_evaluation_without_predictions_gives_a_sentence() -> None:
    results = make_results()
    bare = replace(results, evaluation=replace(results.evaluation, predictions=()))
    assert "no paths to compare" in PathsSection().html(contents_of(bare))


def test_headings_give_times_from_the_start_of_the_log() -> None:
    results = make_results(runs=2)
    epoch = 1.7e9  # s, as in the stamps of a bag

    def later(run: Run) -> Run:
        assert run.commands is not None
        commands = replace(run.commands, t=run.commands.t + epoch)
        return replace(run, commands=commands, poses=replace(run.poses, t=run.poses.t + epoch))

    parts = tuple(
        replace(p, t_start=p.t_start + epoch, t_end=p.t_end + epoch) for p in results.evaluation.predictions
    )
    stamped = replace(
        without_history(results),
        log=replace(results.log, runs=tuple(map(later, results.log.runs))),
        evaluation=replace(results.evaluation, predictions=parts),
    )
    contents = contents_of(stamped)
    text = text_of(typical_path(contents) + PathsSection().html(contents))
    assert "17000" not in text
    timeline = Timeline.of(stamped.log)
    for window in choose_windows(contents):
        start = timeline.seconds(window.run, window.t_start)
        assert 0.0 <= start < 240.0
        assert f"{window.number}: field {window.run}, {start:.1f} s to {start + 5.0:.1f} s" in text


def test_most_various_paths_are_shown_at_once_whatever_their_run() -> None:
    html = PathsSection().html(contents_of(make_results(runs=3)))
    shown, folded = html.split("<details>")
    assert [n for n in figures_of(shown) if "path" in n] == [f"figure-path-{n}" for n in (1, 2, 3)]
    assert "5 more paths and 2 more maps" in folded


def test_typical_path_misses_by_about_the_mean_and_is_drawn_once() -> None:
    contents = contents_of(make_results())
    auto, score = contents.predictions("auto", 5.0), contents.score("auto", 5.0)
    assert auto is not None
    assert score is not None
    (name,) = figures_of(typical_path(contents))
    assert name not in figures_of(PathsSection().html(contents))
    misses = {f"figure-path-{w.number}": float(auto.position_error[w.row]) for w in choose_windows(contents)}
    assert min(misses, key=lambda key: abs(misses[key] - score.position.mean)) == name
