# SPDX-License-Identifier: Apache-2.0
"""The kernel's regression separates what lies apart, and knows how new a window is."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.terrain.kernel_expert import fit_kernel_expert


def rings() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    angle, outer = rng.uniform(0.0, 2.0 * np.pi, 200), np.arange(200) % 2
    radius = 1.0 + 2.0 * outer + 0.1 * rng.standard_normal(200)
    features = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return features, np.stack([1.0 - outer, outer], axis=1)


def test_what_no_line_separates_is_separated() -> None:
    features, indicators = rings()
    expert = fit_kernel_expert(features[:150], indicators[:150], width=4.0, ridge=0.1)
    found = expert.probabilities(features[150:])
    np.testing.assert_allclose(found.sum(axis=1), 1.0)
    assert (found.argmax(axis=1) == indicators[150:].argmax(axis=1)).mean() > 0.95


def test_far_away_every_surface_is_as_probable() -> None:
    features, indicators = rings()
    expert = fit_kernel_expert(features, indicators, width=4.0, ridge=0.1)
    np.testing.assert_allclose(expert.probabilities(np.array([[100.0, 100.0]])), 0.5, atol=1e-9)


def test_newness_grows_with_the_distance() -> None:
    features, indicators = rings()
    expert = fit_kernel_expert(features, indicators, width=4.0, ridge=0.1)
    near, far, farther = expert.newness(np.array([[1.0, 0.0], [5.0, 0.0], [50.0, 0.0]]))
    assert near < far < farther


def test_a_feature_that_never_changes_does_no_harm() -> None:
    features, indicators = rings()
    constant = np.column_stack([features, np.full(len(features), 7.0)])
    expert = fit_kernel_expert(constant, indicators, width=4.0, ridge=0.1)
    assert np.isfinite(expert.probabilities(constant)).all()


def test_a_rare_surface_weighs_more_than_by_its_number() -> None:
    rng = np.random.default_rng(0)
    rare = np.arange(400) % 20 == 0
    features = rng.standard_normal((400, 1)) + 0.7 * rare[:, None]
    indicators = np.stack([~rare, rare], axis=1).astype(float)
    expert = fit_kernel_expert(features, indicators, width=0.5, ridge=5.0)
    found = expert.probabilities(features)[:, 1]
    assert found[rare].mean() > 1.2 * found[~rare].mean()
    assert found.mean() > 1.7 * rare.mean()


def test_distances_are_those_of_the_rows() -> None:
    rng = np.random.default_rng(0)
    first, second = rng.standard_normal((3, 4)), rng.standard_normal((5, 4))
    expected = ((first[:, None] - second) ** 2).sum(axis=2)
    np.testing.assert_allclose(_core.squared_distances(first, second), expected)


def test_a_window_is_as_new_as_the_nearest_five_are_far() -> None:
    rng = np.random.default_rng(1)
    features, indicators = rng.standard_normal((30, 3)), np.eye(2)[rng.integers(0, 2, 30)]
    expert = fit_kernel_expert(features, indicators, width=0.5, ridge=0.1)
    probe = rng.standard_normal((4, 3))
    squared = (((probe[:, None] - features) / features.std(axis=0)) ** 2).sum(axis=2)
    nearest = np.sort(squared, axis=1)[:, :5].mean(axis=1)
    np.testing.assert_allclose(expert.newness(probe), np.log(0.5 / 3 * nearest + 1e-6), atol=1e-9)
