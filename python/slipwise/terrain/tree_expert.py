# SPDX-License-Identifier: Apache-2.0
"""Tells surfaces apart by motor currents: trees as arrays of plain numbers, walked with numpy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

LEAF = -1  # in `feature`: the node is a leaf, and `left` is its row in `leaves`


@dataclass(frozen=True)
class Tree:
    """A binary tree; node 0 is the root."""

    feature: Integers  # [nodes] the column that is compared, or LEAF
    threshold: Floats  # [nodes] to the left where the feature is at most this
    left: Integers  # [nodes]
    right: Integers  # [nodes]
    leaves: Floats  # [leaves, K] share of each surface

    def probabilities(self, features: Floats) -> Floats:
        """Return the share of each surface in the leaf of each row, [M, K], for [M, D]."""
        node = np.zeros(len(features), dtype=np.int64)
        rows = np.arange(len(features))
        while True:
            column = self.feature[node]
            inner = column != LEAF
            if not inner.any():
                return self.leaves[self.left[node]]
            at = node[inner]
            lower = features[rows[inner], column[inner]] <= self.threshold[at]
            node[inner] = np.where(lower, self.left[at], self.right[at])


@dataclass(frozen=True)
class TreeExpert:
    """The mean of several trees."""

    trees: tuple[Tree, ...]

    def probabilities(self, features: Floats) -> Floats:
        """Return the probability of each surface, [M, K], for features [M, D]; not calibrated."""
        return np.asarray(np.mean([tree.probabilities(features) for tree in self.trees], axis=0))
