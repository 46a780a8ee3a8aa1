# SPDX-License-Identifier: Apache-2.0
"""A basis that predicts better than the average of all is found where it is no chance."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from judgements import BETTER, TRUE, judged

from slipwise.calibration.simpler_basis import SimplerBasis, simpler_basis
from slipwise.calibration.verdict import Identified, LogFacts, give_verdict

BASES = ("none", "edd-2", "odd-even-10")


def model(position: tuple[float, ...], heading: tuple[float, ...], count: int) -> Any:
    """A learner's answer whose errors are these on average: of each basis, then of their average."""
    spread = np.random.default_rng(0).uniform(0.5, 1.5, (count, 1))
    return SimpleNamespace(
        weighed_position=spread * np.array(position), weighed_heading=spread * np.array(heading)
    )


def test_two_numbers_that_are_better_by_a_tenth_are_named_with_what_they_gain() -> None:
    found = simpler_basis(BASES, model((2.0, 0.85, 1.1, 1.0), (2.0, 0.95, 1.1, 1.0), 60))
    assert found is not None
    assert found.name == "edd-2"
    assert (round(found.position, 6), round(found.heading, 6)) == (0.85, 0.95)


def test_nothing_is_said_of_less_of_what_is_worse_otherwise_or_of_few_predictions() -> None:
    wrong = {
        "by less than a tenth": model((2.0, 0.95, 1.1, 1.0), (2.0, 0.95, 1.1, 1.0), 60),
        "worse in heading": model((2.0, 0.8, 1.1, 1.0), (2.0, 1.1, 1.1, 1.0), 60),
        "few": model((2.0, 0.8, 1.1, 1.0), (2.0, 0.8, 1.1, 1.0), 12),
        "one basis": SimpleNamespace(weighed_position=np.ones((60, 2)), weighed_heading=np.ones((60, 2))),
    }
    assert [name for name, each in wrong.items() if simpler_basis(BASES, each) is not None] == []


def test_a_model_that_a_simpler_one_beats_is_not_good_and_the_option_is_named() -> None:
    beaten = replace(judged(BETTER, BETTER, TRUE), simpler=SimplerBasis("edd-2", 0.8, 0.95))
    facts = LogFacts((), (), "wheel", False, False)
    assert give_verdict(judged(BETTER, BETTER, TRUE), Identified(2, ()), facts).good
    verdict = give_verdict(beaten, Identified(2, ()), facts)
    assert not verdict.good
    assert "The basis edd-2 misses by 0.800 times its position error and 0.950 times" in verdict.sentence
    assert "Learn with that basis alone: --basis edd-2." in verdict.advice
