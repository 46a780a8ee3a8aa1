# SPDX-License-Identifier: Apache-2.0
"""A state changes only where several judgements in a row say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sample_models import Made, make_model, named

from slipwise.calibration.judgement import Judgement
from slipwise.live.outputs import Validity
from slipwise.live.validity import CONFIRMED, Hysteresis, ModelValidity, judged
from slipwise.models import Model
from slipwise.models.schema import HeldOut


def judgement(segments: int = 40, ratio: tuple[float, float, float] = (0.4, 0.3, 0.5)) -> Judgement:
    held_out = HeldOut(
        horizon=5.0,
        segments=segments,
        position=0.1 * np.nan_to_num(ratio[0]),
        heading=0.1 * np.nan_to_num(ratio[0]),
        baseline_position=0.1,
        baseline_heading=0.1,
    )
    return Judgement(held_out, ratio, ratio, None)


def model(made: Made | None = None, **changes: object) -> Model:
    return make_model(replace(made or named("edd-2"), **changes))  # type: ignore[arg-type]


def test_a_state_holds_until_enough_judgements_agree() -> None:
    state = Hysteresis()
    wanted: list[Validity] = ["estimated", "invalid", "estimated", "estimated"]
    assert [state.take(each) for each in wanted] == ["unestimated"] * 4
    assert state.take("estimated") == "estimated"
    for _ in range(CONFIRMED - 1):
        assert state.take("invalid") == "estimated"
    assert state.take("estimated") == "estimated"
    assert [state.take("invalid") for _ in range(CONFIRMED)][-1] == "invalid"


def test_what_speaks_for_a_change_is_forgotten_where_the_terrain_changed() -> None:
    state = Hysteresis()
    for _ in range(CONFIRMED - 1):
        state.take("estimated")
    state.suspend()
    assert state.take("estimated") == "unestimated"


def test_a_good_verdict_is_estimated_a_worse_model_invalid_and_little_driving_neither() -> None:
    assert judged(model(), judgement())[0] == "estimated"
    bad = model(good=False)
    assert judged(bad, judgement(ratio=(1.3, 1.1, 1.5)))[0] == "invalid"
    assert judged(bad, judgement(segments=2, ratio=(np.nan, np.nan, np.nan)))[0] == "unestimated"
    chance = judgement(ratio=(0.99, 0.9, 1.1))
    assert judged(bad, chance)[0] == "unestimated"


def test_parameters_have_a_validity_each() -> None:
    validity = ModelValidity()
    unknown, known = model(identifiable=False), model()
    for _ in range(CONFIRMED):
        validity.take(unknown, judgement())
    assert validity.whole == "estimated"
    names = [p.name for p in known.content.parameters]
    assert {validity.of(name) for name in names} == {"unestimated"}
    for _ in range(CONFIRMED):
        validity.take(known, judgement())
    assert {validity.of(name) for name in names} == {"estimated"}
    for _ in range(CONFIRMED):
        validity.take(model(good=False), judgement(ratio=(1.3, 1.1, 1.5)))
    assert {validity.of(name) for name in names} == {"invalid"}
    assert validity.of("no such parameter") == "unestimated"
