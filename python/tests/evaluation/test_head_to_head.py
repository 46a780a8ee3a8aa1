# SPDX-License-Identifier: Apache-2.0
"""Of two model files the better one is named where the intervals say so, and only then."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sample_logs import Drive, simulated_log
from sample_models import make_model, named

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.evaluation.head_to_head import HeadToHead, head_to_head

LOG = simulated_log(Drive(seconds=60.0, basis=_core.named_basis("edd-2"), alpha=(-0.1, -0.4)))
TRUE, WRONG = make_model(named("edd-2", lon__V=-0.1, ang__w=-0.4)), make_model(named("edd-2", ang__w=-0.2))


def test_several_models_are_methods_under_their_names() -> None:
    options = EvaluationOptions((2.0,), None, model={"a.yaml": TRUE, "b.yaml": WRONG})
    names = ("none", "a.yaml", "b.yaml")
    result = evaluate(LOG, options=replace(options, methods=names))
    assert (result.input, result.methods, result.models) == ("wheel", names, names[1:])
    alone = evaluate(LOG, options=EvaluationOptions((2.0,), ("none", "model"), model=TRUE))
    assert alone.score("model", 2.0).position == result.score("a.yaml", 2.0).position
    match = head_to_head(result, "a.yaml", "b.yaml")
    assert match.better == "a.yaml"
    assert match.position[0] > 2.0
    swapped = head_to_head(result, "b.yaml", "a.yaml")
    assert swapped.better == "a.yaml"
    assert swapped.position[0] == pytest.approx(1.0 / match.position[0])
    assert head_to_head(result, "a.yaml", "a.yaml").better is None


def test_nothing_is_better_that_is_worse_in_the_other_error() -> None:
    both = HeadToHead("a", "b", 5.0, 10, (0.5, 0.4, 0.6), (1.5, 1.2, 1.8), (0.2, 0.1), (0.02, 0.03))
    assert both.better is None
    assert replace(both, heading=(1.1, 0.9, 1.3)).better == "b"
    assert replace(both, heading=(1.1, 0.9, 1.3), windows=3).better is None
    assert replace(both, position=(1.0, 0.9, 1.1)).better == "a"


def test_a_model_does_not_take_the_name_of_a_method() -> None:
    with pytest.raises(SettingsError, match="a model has the name of the method auto"):
        evaluate(LOG, options=EvaluationOptions(model={"auto": TRUE}))


def test_models_of_different_inputs_are_refused() -> None:
    commands = make_model(replace(named("edd-2"), commands=True))
    with pytest.raises(SettingsError, match="b was learned from command input, not wheel"):
        evaluate(LOG, options=EvaluationOptions(model={"a": TRUE, "b": commands}))
