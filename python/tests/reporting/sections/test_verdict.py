# SPDX-License-Identifier: Apache-2.0
"""The section of the verdict."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from reporting.page_parts import contents_of, figures_of, text_of
from reporting.synthetic_results import make_results, with_model, with_verdict

from slipwise.calibration.next_step import after_learning
from slipwise.calibration.result import Verdict
from slipwise.models.summary import summarise, verdict_label
from slipwise.reporting.sections.verdict import VerdictSection


@pytest.mark.parametrize(
    ("verdict", "state"),
    [
        (Verdict(True, "Fine."), "good"),
        (Verdict(True, "Fine.", ("lat.w",), ("Turn on the spot.",)), "good"),
        (Verdict(True, "Fine.", reservations=("Its reported uncertainty is too small.",)), "reserved"),
        (Verdict(False, "No.", ("lat.w",)), "bad"),
    ],
)
def test_colour_follows_the_verdict(verdict: Verdict, state: str) -> None:
    html = VerdictSection().html(contents_of(with_verdict(make_results(), verdict)))
    assert f'<div class="verdict {state}"' in html


def test_verdict_names_what_is_not_determined_and_the_drive_that_would() -> None:
    verdict = Verdict(True, "Fine.", ("lat.w", "ang.V"), ("Turn on the spot.",))
    text = text_of(VerdictSection().html(contents_of(with_verdict(make_results(), verdict))))
    assert "Not identifiable from this log: lat.w, ang.V." in text
    assert (
        "What to do Check it on another day: slipwise evaluate OTHER_LOG --model model.yaml "
        "Export it: slipwise export model.yaml --to all -o config Turn on the spot." in text
    )


def test_errors_stand_beside_those_of_the_baseline_model() -> None:
    results = make_results()
    contents = contents_of(results)
    plain, auto = (results.evaluation.score(name, 5.0) for name in ("none", "auto"))
    text = text_of(VerdictSection().html(contents))
    times = round(plain.position.mean / auto.position.mean)
    assert (
        f"Position error after 5 s {auto.position.mean:.4f} m "
        f"kinematic baseline: {plain.position.mean:.2f} m, {times} times as much" in text
    )


def test_errors_are_those_of_the_method_that_was_calibrated() -> None:
    results = make_results()
    provenance = results.calibration.model.content.provenance.model_copy(
        update={"settings": {"basis": "odd-even-10"}}
    )
    contents = contents_of(with_model(results, provenance=provenance))
    assert contents.learned_method == "odd-even-10"
    error = results.evaluation.score("odd-even-10", 5.0).position.mean
    assert f"Position error after 5 s {error:.4f} m" in text_of(VerdictSection().html(contents))


@pytest.mark.parametrize("reservations", [(), ("It answers late.",)])
@pytest.mark.parametrize("good", [True, False])
def test_banner_says_what_the_terminal_says(good: bool, reservations: tuple[str, ...]) -> None:
    verdict = Verdict(good, "Fine or not.", reservations=reservations)
    text = text_of(VerdictSection().html(contents_of(with_verdict(make_results(), verdict))))
    assert f"{verdict_label(verdict)[0]} Fine or not." in text


def test_three_paths_are_on_the_first_screen() -> None:
    html = VerdictSection().html(contents_of(make_results()))
    (figure,) = figures_of(html).values()
    assert [trace["name"] for trace in figure["data"] if "name" in trace] == [
        "kinematic baseline",
        "measured",
        "slipwise",
    ]
    assert "measured kinematic baseline slipwise 95 % ellipse" in text_of(html)


def test_what_was_learned_is_said_in_the_words_of_the_summary() -> None:
    results = make_results()
    text = text_of(VerdictSection().html(contents_of(results)))
    summary = summarise(results.calibration.model)
    learned = set(summary.sentences) - set(summary.prediction)
    assert learned
    assert all(sentence in text for sentence in learned)


def test_bad_model_is_not_to_be_used_or_exported() -> None:
    verdict = Verdict(False, "No.", (), ("Record wheel speeds.",))
    text = text_of(VerdictSection().html(contents_of(with_verdict(make_results(), verdict))))
    assert (
        f"What to do Do not use this model. {' '.join(after_learning(verdict, Path('model.yaml')))} "
        "Record wheel speeds." in text
    )
    assert "slipwise export" not in text


def test_truth_of_the_stated_uncertainty_is_answered() -> None:
    text = text_of(VerdictSection().html(contents_of(make_results())))
    assert "Is the reported uncertainty true? Yes" in text


def test_verdict_without_scores_is_still_a_verdict() -> None:
    results = make_results()
    bare = replace(results, evaluation=replace(results.evaluation, scores=()))
    text = text_of(VerdictSection().html(contents_of(bare)))
    assert "The learned model misses by 0.1 m after 5 s." in text
    assert "There are no held-out errors beside those of the kinematic baseline." in text
