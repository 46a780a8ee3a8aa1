# SPDX-License-Identifier: Apache-2.0
"""The section of what was left out."""

from __future__ import annotations

from dataclasses import replace

from reporting.page_parts import contents_of, text_of
from reporting.synthetic_results import make_results

from slipwise.reporting.sections.left_out import LeftOutSection


def test_kind_count_place_reason_and_stage_are_listed() -> None:
    text = text_of(LeftOutSection().html(contents_of(make_results())))
    assert "duplicate-stamp 3 row 17 the stamp stands twice reading the log" in text
    assert "unknown-input 2 t = 3.0 s the input is unknown scoring" in text
    assert "the pose topic /odom was guessed" in text


def test_what_stages_hand_on_is_listed_once() -> None:
    results = make_results()
    again = replace(
        results,
        evaluation=replace(results.evaluation, left_out=results.log.left_out, notes=results.log.notes),
    )
    text = text_of(LeftOutSection().html(contents_of(again)))
    assert text.count("duplicate-stamp") == 1
    assert text.count("/odom") == 1


def test_nothing_left_out_is_said() -> None:
    results = make_results()
    clean = replace(
        results,
        log=replace(results.log, left_out=(), notes=()),
        evaluation=replace(results.evaluation, left_out=()),
    )
    text = text_of(LeftOutSection().html(contents_of(clean)))
    assert text == "Nothing was left out. Nothing was guessed."
