# SPDX-License-Identifier: Apache-2.0
"""Drawn segments scatter as the covariance says, from P0 alone, slip noise alone and both."""

from __future__ import annotations

import numpy as np
import pytest
from steady_paths import NOISE, PSD, START

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady import DrawRules, draw_paths

TWIST = _core.BodyTwist(0.5, 0.0, 0.25)
NOTHING = np.zeros(3)


@pytest.mark.parametrize(
    ("start", "process", "noise"),
    [
        (True, True, NOISE),
        (True, False, _thesis.SteadyNoise(NOTHING, START, NOTHING)),
        (False, True, _thesis.SteadyNoise(PSD, NOTHING, NOTHING)),
    ],
)
def test_terminal_spread_is_that_of_the_variance_equation(
    start: bool, process: bool, noise: _thesis.SteadyNoise
) -> None:
    drawn = draw_paths(
        TWIST, NOISE, seed=1, rules=DrawRules(count=2000, start=start, process=process, period=0.1)
    )
    expected = _thesis.steady_covariance(TWIST, np.array([3.0]), noise)
    factor = np.linalg.inv(np.linalg.cholesky(expected))
    white = factor @ np.cov(drawn.poses[:, -1].T) @ factor.T
    np.testing.assert_allclose(white, np.eye(3), atol=0.15)


def test_without_noise_every_segment_is_the_steady_path_from_the_start() -> None:
    drawn = draw_paths(TWIST, NOISE, seed=1, rules=DrawRules(count=2, start=False, process=False))
    np.testing.assert_allclose(drawn.poses[1], _thesis.steady_path(TWIST, drawn.times), atol=1e-12)


def test_the_seed_decides() -> None:
    first, again, other = (
        draw_paths(TWIST, NOISE, seed=seed, rules=DrawRules(count=3)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first.poses, again.poses)
    assert not np.array_equal(first.poses, other.poses)


def test_rules_that_make_no_sense_are_refused() -> None:
    for rules in (DrawRules(count=0), DrawRules(length=-1.0), DrawRules(period=0.0)):
        with pytest.raises(SettingsError):
            draw_paths(TWIST, NOISE, seed=1, rules=rules)
    with pytest.raises(SettingsError, match="negative"):
        draw_paths(TWIST, _thesis.SteadyNoise(-PSD, START, NOTHING), seed=1)
    with pytest.raises(SettingsError, match="not finite"):
        draw_paths(TWIST, _thesis.SteadyNoise(PSD, START * np.nan, NOTHING), seed=1)
