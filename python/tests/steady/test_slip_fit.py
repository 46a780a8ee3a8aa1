# SPDX-License-Identifier: Apache-2.0
"""Figure 4.2 in numbers: three channels fit as a polynomial does, translation alone does not."""

from __future__ import annotations

import numpy as np
import pytest
from steady_paths import NOISE, QUIET, SLIP, drawn_group

from slipwise.errors import LogError
from slipwise.steady import SlipFitRules, compare_fits, fit_slip


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
