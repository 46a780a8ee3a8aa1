# SPDX-License-Identifier: Apache-2.0
"""The section of the scores."""

from __future__ import annotations

import re
from dataclasses import replace

from reporting.page_parts import contents_of, text_of
from reporting.synthetic_results import make_results

from slipwise.reporting.sections.scores import ScoresSection


def _html() -> str:
    return ScoresSection().html(contents_of(make_results()))


def _methods(html: str) -> list[str]:
    return re.findall(r'<th scope="row"><span[^>]*></span>([^<]+)', html)


def test_main_methods_come_first_and_the_others_are_folded_away() -> None:
    shown, folded = _html().split("<details>")
    main = ["kinematic baseline", "vendor multiplier", "edd-2", "slipwise"]
    assert _methods(shown) == main
    assert _methods(folded) == 2 * [*main, "odd-even-10", "batch"]
    assert "All figures, and 2 other methods" in folded


def test_each_method_is_explained_where_it_first_stands() -> None:
    text = text_of(_html().split("<details>")[0])
    assert "kinematic baseline the robot follows the commands at once: no slip, lag or delay 1." in text
    assert "edd-2 two fitted factors, of speed and of yaw rate, with lag and delay 0." in text


def test_longest_horizon_comes_first() -> None:
    assert re.findall(r">(after .*?) \(", _html()) == ["after 5 s", "after 2 s"]
    assert re.findall(r"<td>(\d s)</td>", _html()) == 6 * ["5 s"] + 6 * ["2 s"]


def test_method_that_saw_the_windows_is_marked() -> None:
    batch = _html().split(">batch<")[1].split("</tr>")[0]
    assert "not causal" in text_of(batch)
    assert _html().count("not causal") == 2  # at both horizons


def test_in_sample_column_stands_once_and_is_named_as_too_optimistic() -> None:
    text = text_of(_html())
    assert text.count("in-sample: too optimistic") == 1
    assert "0.0123 m, 0.573°" in text


def test_table_shows_nis_with_its_band_and_the_coverage() -> None:
    text = text_of(_html())
    assert "2.20 to 3.90" in text
    assert "48, 91, 96 %" in text


def test_ratios_that_do_not_exist_are_dashes() -> None:
    results = make_results()
    nan = float("nan")
    scores = tuple(
        replace(
            s, position_ratio=(nan, nan, nan), heading_ratio=(nan, nan, nan), position_to_rival=nan, nis=nan
        )
        for s in results.evaluation.scores
    )
    html = ScoresSection().html(
        contents_of(replace(results, evaluation=replace(results.evaluation, scores=scores)))
    )
    assert "nan" not in html
    assert html.count("<td>–</td>") == 3 * len(scores)


def test_evaluation_without_scores_gives_a_sentence() -> None:
    results = make_results()
    bare = replace(results, evaluation=replace(results.evaluation, scores=()))
    assert "could be scored" in ScoresSection().html(contents_of(bare))
