# SPDX-License-Identifier: Apache-2.0
"""Tells surfaces apart by motor currents: trees as arrays of plain numbers, walked by the core."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.terrain.features import CURRENT_FEATURES

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

    @property
    def in_core(self) -> _core.TerrainTree:
        """The tree as the core walks it."""
        left, right = self.left.tolist(), self.right.tolist()
        return _core.TerrainTree(self.feature.tolist(), self.threshold.tolist(), left, right, self.leaves)


@dataclass(frozen=True)
class TreeExpert:
    """The mean of several trees."""

    trees: tuple[Tree, ...]

    features: int = len(CURRENT_FEATURES)  # of a window, in which the trees look

    @cached_property
    def in_core(self) -> _core.TreeExpert:
        """The expert as the core evaluates it."""
        return _core.TreeExpert([tree.in_core for tree in self.trees], self.features)

    def probabilities(self, features: Floats) -> Floats:
        """Return the probability of each surface, [M, K], for features [M, D]; not calibrated."""
        return np.asarray(self.in_core.probabilities(features))
