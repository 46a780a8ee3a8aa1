# SPDX-License-Identifier: Apache-2.0
"""Variants of the learner: each changes what it says, and is scored as `evaluate` scores."""

from __future__ import annotations

from pathlib import Path

import pytest
from variants import Variant, of_input, scaled, score_variants

import slipwise
from slipwise import _core

LOG = "first/short"


def test_the_default_is_scored_as_evaluate_does(data: Path) -> None:
    (scores,) = score_variants([Variant()], [LOG], workers=1)
    assert scores is not None
    assert [score.input for score in scores] == ["wheel", "command"]
    log = slipwise.open_log(data / f"{LOG}.csv.gz")
    for score in scores:
        options = slipwise.EvaluationOptions(horizons=(5.0,), methods=("none", "auto"))
        evaluation = slipwise.evaluate(log, input=score.input, options=options)
        (auto,) = [each for each in evaluation.scores if each.method == "auto"]
        assert score.windows == auto.windows
        assert score.position == pytest.approx(auto.position_ratio[0], rel=1e-12)
        assert score.heading == pytest.approx(auto.heading_ratio[0], rel=1e-12)
        assert score.inside == pytest.approx(auto.coverage)
        assert score.seconds > 0.0


def test_each_variant_changes_what_it_says(data: Path) -> None:
    variants = [
        Variant(),
        Variant("settings", settings={"auto": {"structures": ["joint"]}}),
        Variant("numbers", numbers={"hypotheses.filter.prior.slip_fraction": 0.5}),
        Variant("limits", limits=True),
    ]
    default, joint, certain, limits = score_variants(variants, [LOG])
    assert default
    assert joint
    assert certain
    assert limits
    (before,), (without,) = of_input(default, "command"), of_input(joint, "command")
    assert without.position != before.position
    assert all(a.position != b.position for a, b in zip(certain, default, strict=True))
    assert [s.position for s in limits] == [s.position for s in default]
    assert of_input(limits, "command")[0].limits_seconds > of_input(default, "command")[0].limits_seconds


def test_what_the_learner_refuses_has_no_score(data: Path) -> None:
    assert score_variants([Variant("none", settings={"segment": {"length": -1.0}})], [LOG]) == [None]


def test_a_constant_needs_a_build_of_its_own(data: Path) -> None:
    with pytest.raises(SystemExit, match="tuning constants"):
        score_variants([Variant("constant", constants={"iekf.kUnknown": 2.0})], [LOG])


def test_numbers_are_multiplied_and_whole_ones_stay_whole() -> None:
    core = _core.LearnerSettings()
    scaled(core, "hypotheses.average.surfaces.trial", 0.4)
    scaled(core, "hypotheses.average.weighting.fraction", 2.0)
    scaled(core, "disturbance.time_constants", 0.5)
    fresh = _core.LearnerSettings()
    assert core.hypotheses.average.surfaces.trial == round(0.4 * fresh.hypotheses.average.surfaces.trial)
    assert core.hypotheses.average.weighting.fraction == 2.0 * fresh.hypotheses.average.weighting.fraction
    assert core.disturbance.time_constants == [0.5 * t for t in fresh.disturbance.time_constants]
    scaled(core, "hypotheses.average.surfaces.trial", 1e-9)
    assert core.hypotheses.average.surfaces.trial == 1
