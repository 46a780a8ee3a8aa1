# SPDX-License-Identifier: Apache-2.0
"""Slip noise and P0 from scatter: recovery with coverage, both objectives, and data that cannot tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from steady_paths import PSD, START, drawn_group

from slipwise.errors import LogError, SettingsError
from slipwise_thesis import _thesis
from slipwise_thesis.steady import NoiseRules, fit_group_noise

TRUTH = np.concatenate((PSD, START))


def stacked(noise: _thesis.SteadyNoise) -> np.ndarray:
    return np.concatenate((noise.psd, noise.start))


def test_noise_and_start_are_covered_over_seeds_and_fisher_beats_the_thesis() -> None:
    seeds = 40
    errors = {}
    covered = np.zeros(6)
    for objective in (_thesis.NoiseObjective.Fisher, _thesis.NoiseObjective.Thesis):
        rows = []
        for seed in range(seeds):
            found = fit_group_noise([drawn_group(seed=seed)], NoiseRules(objective=objective))
            error = stacked(found.noise) - TRUTH
            rows.append(error)
            if objective == _thesis.NoiseObjective.Fisher:
                covered += np.abs(error) < 3.0 * np.sqrt(np.diag(found.covariance))
        errors[objective.name] = np.sqrt(np.mean(np.array(rows) ** 2, axis=0))
    assert np.all(covered >= seeds - 3)
    assert np.all(errors["Fisher"] < errors["Thesis"])


def test_both_centres_agree_where_the_curve_fits() -> None:
    group = drawn_group(seed=7, count=200)
    mean = stacked(fit_group_noise([group], NoiseRules(centre=_thesis.ScatterCentre.Mean)).noise)
    curve = stacked(fit_group_noise([group], NoiseRules(centre=_thesis.ScatterCentre.Curve)).noise)
    np.testing.assert_allclose(mean, curve, rtol=0.15)


def test_few_segments_are_refused_or_left_out_aloud() -> None:
    few, many = drawn_group(seed=1, count=2), drawn_group(seed=2, command=(1.0, 0.1))
    with pytest.raises(LogError, match="at least 3 segments, got 2"):
        fit_group_noise([few])
    with pytest.raises(LogError, match="no groups"):
        fit_group_noise([])
    assert "1 groups with fewer than 3 segments were left out" in fit_group_noise([few, many]).notes


def test_duplicate_segments_are_refused_and_a_scatter_of_short_rank_is_named() -> None:
    group = drawn_group(seed=3, count=4)
    with pytest.raises(LogError, match="duplicates"):
        fit_group_noise([replace(group, paths=group.paths[:1] * 5)])
    notes = fit_group_noise([replace(group, paths=group.paths[:3])]).notes
    assert any("not positive definite" in note for note in notes)


def test_one_time_is_refused() -> None:
    with pytest.raises(SettingsError, match="at least two"):
        fit_group_noise([drawn_group(seed=1)], NoiseRules(times=1))


@pytest.mark.parametrize("std", [-0.01, np.nan, np.inf])
def test_a_standard_deviation_of_poses_that_makes_no_sense_is_refused(std: float) -> None:
    with pytest.raises(SettingsError, match="pose_std"):
        fit_group_noise([drawn_group(seed=1, count=3)], NoiseRules(pose_std=(std, 0.0, 0.0)))
