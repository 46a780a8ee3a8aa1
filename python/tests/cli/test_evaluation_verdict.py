# SPDX-License-Identifier: Apache-2.0
"""The method judged is the one that a model file could hold; what is said of it is what calibrations say."""

from __future__ import annotations

from dataclasses import replace

import pytest
from contradictory_logs import sound_log, turned

from slipwise.calibration import calibrate, make_settings
from slipwise.cli.evaluation_verdict import judged_method, verdict_on
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.models import Model


def test_first_method_that_learns_a_model_is_judged_after_model_and_auto(subtests: pytest.Subtests) -> None:
    for methods, judged in [
        (("none", "edd-2", "auto"), "auto"),
        (("none", "auto", "model"), "model"),
        (("none", "vendor", "batch", "icr-3", "ipem-9"), "icr-3"),
        (("none", "slip-ratio-ekf", "slip-ratio-smo", "edd-2"), "edd-2"),
        (("none", "slip-ratio-ekf", "slip-ratio-smo"), None),
        (("none", "vendor", "batch"), None),
    ]:
        with subtests.test(methods=methods, judged=judged):
            assert judged_method(methods) == judged


def test_an_evaluation_and_a_calibration_say_the_same_of_the_same_log() -> None:
    settings = make_settings({"basis": "edd-2"})
    calibration = calibrate(sound_log(), input="wheel", settings=settings)
    options = EvaluationOptions(methods=("none", "edd-2"))
    evaluation = evaluate(sound_log(), input="wheel", settings=settings, options=options)
    verdict = verdict_on(evaluation, calibration)
    assert verdict is not None
    assert verdict.sentence == calibration.verdict.sentence
    assert verdict.reservations == calibration.verdict.reservations
    assert set(calibration.verdict.advice) <= set(verdict.advice)


def test_a_model_that_is_given_is_judged_whatever_else_is_asked_for() -> None:
    model = calibrate(sound_log(), input="wheel", settings=make_settings({"basis": "edd-2"})).model
    tripled = [p.model_copy(update={"value": 3.0 * p.value}) for p in model.content.parameters]
    worse = Model(model.content.model_copy(update={"parameters": tripled}))
    other = replace(sound_log(), sources=())
    said = []
    for methods in (("none", "edd-2"), ("none", "model"), None):
        options = EvaluationOptions(methods=methods, model=worse)
        evaluation = evaluate(other, input="wheel", options=options)
        verdict = verdict_on(evaluation, worse)
        assert verdict is not None
        said.append((verdict.good, verdict.sentence))
        error = f"{evaluation.score('model', 5.0).position.mean:.3g} m"
        assert f"The model misses by {error}" in verdict.sentence
    assert said[0] == said[1] == said[2]


def test_an_evaluation_on_a_log_that_contradicts_itself_is_not_good_though_the_model_is() -> None:
    model = calibrate(sound_log(), input="wheel", settings=make_settings({"basis": "edd-2"})).model
    other = replace(turned(sound_log(), 1.5707963), sources=())
    options = EvaluationOptions(methods=("none", "model"), model=model)
    verdict = verdict_on(evaluate(other, input="wheel", options=options), model)
    assert model.content.verdict.good
    assert verdict is not None
    assert not verdict.good
    assert "the poses move to the right of their heading" in verdict.sentence
    assert "--pose-yaw-offset -1.5708" in verdict.advice[0]
