# SPDX-License-Identifier: Apache-2.0
"""Whether the reported uncertainty is true, in words."""

from __future__ import annotations

from dataclasses import replace

import pytest
from reporting.page_parts import contents_of
from reporting.synthetic_results import make_results

from slipwise.evaluation.result import Score
from slipwise.reporting.uncertainty import _at_most, honesty_of


def _score(**changes: object) -> Score:
    score = contents_of(make_results()).score("auto", 5.0)
    assert score is not None
    return replace(score, **{"windows": 40, "nis": 3.1, "nis_band": (2.3, 3.8), **changes})


def test_answer_follows_coverage_and_nis(subtests: pytest.Subtests) -> None:
    for coverage, nis, answer in [
        (0.95, 3.1, "Yes"),
        (1.0, 1.2, "Yes, with a margin"),
        (0.925, 4.4, "Nearly, it is a little small"),
        (0.80, 12.0, "No, it is too small"),
        (0.80, 3.1, "No, it is too small"),
    ]:
        with subtests.test(coverage=coverage, nis=nis, answer=answer):
            honesty = honesty_of(_score(coverage=(0.5, 0.9, coverage), nis=nis))
            assert honesty is not None
            assert honesty.answer == answer
            assert honesty.sentence.count(f"{round(40 * coverage)} of 40 measured ends") == 1


def test_errors_of_a_covariance_four_times_too_small_are_twice_as_large() -> None:
    honesty = honesty_of(_score(coverage=(0.1, 0.4, 0.5), nis=12.0))
    assert honesty is not None
    assert honesty.short == "errors are 2.0 times as large as it says"


def test_without_a_covariance_nothing_is_said() -> None:
    assert honesty_of(None) is None
    assert honesty_of(_score(nis=float("nan"))) is None
    assert honesty_of(_score(windows=0)) is None


def test_probability_of_few_held_ends_is_the_binomial_one() -> None:
    assert _at_most(40, 40) == pytest.approx(1.0)
    assert _at_most(0, 2) == pytest.approx(0.05**2)
    assert _at_most(1, 2) == pytest.approx(1.0 - 0.95**2)
