# SPDX-License-Identifier: Apache-2.0
"""Trees of plain numbers lead each row to its leaf (terrain_experts)."""

from __future__ import annotations

import numpy as np
import pytest

from slipwise.terrain.tree_expert import LEAF, Tree, TreeExpert


def stump(threshold: float) -> Tree:
    return Tree(
        feature=np.array([1, LEAF, LEAF]),
        threshold=np.array([threshold, 0.0, 0.0]),
        left=np.array([1, 0, 1]),
        right=np.array([2, 0, 0]),
        leaves=np.array([[1.0, 0.0], [0.25, 0.75]]),
    )


def test_at_most_the_threshold_goes_to_the_left() -> None:
    features = np.array([[9.0, 0.5], [9.0, 0.51], [-9.0, -3.0]])
    np.testing.assert_allclose(
        TreeExpert((stump(0.5),), 2).probabilities(features), [[1.0, 0.0], [0.25, 0.75], [1.0, 0.0]]
    )


def test_a_tree_of_one_leaf_says_the_same_everywhere() -> None:
    leaf = Tree(
        np.array([LEAF]), np.zeros(1), np.zeros(1, dtype=int), np.zeros(1, dtype=int), np.array([[0.4, 0.6]])
    )
    np.testing.assert_allclose(TreeExpert((leaf,), 2).probabilities(np.zeros((3, 2))), [[0.4, 0.6]] * 3)


def test_several_trees_are_averaged() -> None:
    expert = TreeExpert((stump(0.0), stump(1.0)), 2)
    np.testing.assert_allclose(expert.probabilities(np.array([[0.0, 0.5]])), [[0.625, 0.375]])


def test_a_tree_that_leads_in_a_circle_is_refused() -> None:
    circle = Tree(
        np.array([0, LEAF]), np.zeros(2), np.array([0, 0]), np.array([1, 0]), np.array([[0.5, 0.5]])
    )
    with pytest.raises(ValueError, match="nodes that lead nowhere"):
        TreeExpert((circle,), 2).probabilities(np.zeros((1, 2)))
