# SPDX-License-Identifier: Apache-2.0
"""Every situation times every use: right against a known truth, or refused with advice."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from matrix.drives import SECONDS
from matrix.expected import refusal, why_wrong
from matrix.learned import Learned, RefusalError
from matrix.situation import Situation
from matrix.situations import SITUATIONS
from matrix.uses import OWN, USES

from slipwise.errors import SlipwiseError

SLOW = (
    "report",
    "compare",
    "evaluate",
    "excite",
    "replay",
    "lines",
    "parquet",
    "mcap",
    "several-logs",
    "fleet",
)


@pytest.fixture(scope="session")
def learned_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Situation], Learned]:
    kept: dict[str, Learned] = {}

    def learned(situation: Situation) -> Learned:
        if situation.name not in kept:
            kept[situation.name] = Learned(situation, tmp_path_factory.mktemp(situation.name))
        return kept[situation.name]

    return learned


def cells() -> list[object]:
    found: list[object] = []
    for situation in SITUATIONS:
        for use in (*(situation.uses or USES), *situation.also):
            if use in situation.without:
                continue
            slow = situation.slow or use in SLOW
            marks = [pytest.mark.slow] if slow else []
            why = why_wrong(situation, use)
            if why is not None:
                marks.append(pytest.mark.xfail(reason=why, strict=True))
            found.append(pytest.param(situation, use, id=f"{situation.name}-{use}", marks=marks))
    return found


@pytest.mark.parametrize(("situation", "use"), cells())
def test_a_cell_is_right_or_refused_with_advice(
    situation: Situation, use: str, learned_of: Callable[[Situation], Learned]
) -> None:
    expected = refusal(situation, use)
    try:
        (USES | OWN)[use](learned_of(situation))
    except (RefusalError, SlipwiseError) as problem:
        said = str(problem)
        assert expected is not None, f"refused: {said}"
        assert expected in said
        assert ": " in said.removeprefix("slipwise: "), f"refused without advice: {said}"
    else:
        assert expected is None, "no longer refused: take it out of REFUSED"


@pytest.mark.parametrize("situation", SITUATIONS, ids=lambda each: each.name)
def test_a_model_that_knows_nothing_would_miss_by_far_more_than_the_bound(situation: Situation) -> None:
    manoeuvre = situation.manoeuvre
    truth, ideal = (situation.end(manoeuvre, SECONDS, robot) for robot in (None, situation.ideal))
    off = np.abs(truth - ideal)
    assert max(np.hypot(*off[:2]) / situation.bound[0], off[2] / situation.bound[1]) > 3.0
