# SPDX-License-Identifier: Apache-2.0
"""Figure 4.2 in numbers: three channels fit as a polynomial does, translation alone does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from steady_paths import NOISE, QUIET, SLIP, drawn_group

from slipwise.errors import LogError, SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady import SlipFitRules, compare_fits, fit_slip


def test_slip_rates_are_recovered_within_three_sigma() -> None:
    for rules in (SlipFitRules(), SlipFitRules(noise=NOISE)):
        fit = fit_slip(drawn_group(seed=1), rules)
        assert np.all(np.abs(fit.slip - SLIP) < 3.0 * np.sqrt(np.diag(fit.covariance)))


def test_three_channels_fit_like_the_polynomial_and_translation_does_not() -> None:
    comparison = compare_fits(drawn_group(seed=2, noise=QUIET))
    full, polynomial = comparison.curve("three channels"), comparison.curve("polynomial")
    translation, none = comparison.curve("translation"), comparison.curve("no slip")
    assert full.cost < 1.2 * polynomial.cost
    assert translation.cost > 20.0 * full.cost
    assert translation.rms_heading > 10.0 * full.rms_heading
    assert none.cost >= translation.cost
    assert comparison.to_polynomial < 0.2 * comparison.translation_to_polynomial
    assert comparison.translation[2] == 0.0


def test_one_segment_is_refused_by_name_unless_the_noise_is_given() -> None:
    group = drawn_group(seed=3, count=1)
    with pytest.raises(LogError, match=r"at least two segments.*0.5 m/s, curvature 0.5 1/m"):
        fit_slip(group)
    assert fit_slip(group, SlipFitRules(noise=NOISE)).covariance[2, 2] > 0.0


def test_no_segments_are_refused_by_name() -> None:
    empty = replace(drawn_group(seed=3, count=2), paths=())
    for fit in (fit_slip, compare_fits):
        with pytest.raises(LogError, match=r"got 0.*0.5 m/s, curvature 0.5 1/m"):
            fit(empty)


def test_a_segment_that_is_there_twice_is_refused_and_not_taken_for_two_that_agree() -> None:
    group = drawn_group(seed=3, count=3)
    twice = replace(group, paths=(*group.paths, group.paths[1]))
    for rules in (SlipFitRules(), SlipFitRules(noise=NOISE)):
        with pytest.raises(LogError, match=r"duplicates.*0.000 s of run drawn.*give each log once"):
            fit_slip(twice, rules)


def test_noise_and_points_that_make_no_sense_are_refused() -> None:
    group = drawn_group(seed=3, count=3)
    nothing = np.zeros(3)
    with pytest.raises(SettingsError, match="not finite"):
        fit_slip(group, SlipFitRules(noise=_thesis.SteadyNoise(np.full(3, np.nan), nothing, nothing)))
    with pytest.raises(LogError, match="not positive definite"):
        fit_slip(group, SlipFitRules(noise=_thesis.SteadyNoise(nothing, nothing, nothing)))
    with pytest.raises(SettingsError, match="at least two"):
        compare_fits(group, points=1)


def test_a_pose_that_is_no_number_is_refused() -> None:
    group = drawn_group(seed=3, count=2)
    poses = group.paths[0].poses.copy()
    poses[4, 0] = np.nan
    broken = replace(group, paths=(replace(group.paths[0], poses=poses), group.paths[1]))
    with pytest.raises(LogError, match="finite poses"):
        fit_slip(broken)
