# SPDX-License-Identifier: Apache-2.0
"""Fits the experts of a terrain classifier: one for vibration, one for motor currents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SlipwiseError
from slipwise.extras import to_install
from slipwise.terrain.kernel_expert import KernelExpert, fit_kernel_expert
from slipwise.terrain.tree_expert import LEAF, Tree, TreeExpert
from slipwise.terrain.windows import Windows

Floats = NDArray[np.float64]

MOST_CENTRES = 1500  # windows of the kernel; more are thinned evenly
TREES, LEAST_IN_LEAF, FEATURES_TRIED = 60, 5, 0.5
THINNED = 3  # every third window of the currents, which overlap
MOST_FOR_TREES = 6000  # windows
DIGITS = 7  # of a threshold


@dataclass(frozen=True)
class Shape:
    """Smoothness of the kernel's regression."""

    width: float  # gamma times the number of features
    ridge: float


@dataclass(frozen=True)
class Experts:
    """The vibration's expert in each shape that was asked for, and the currents' expert."""

    vibration: tuple[KernelExpert, ...]
    current: TreeExpert | None

    def kinds(self) -> list[str]:
        """Return what a window may have, of what there is an expert for."""
        both = bool(self.vibration) and self.current is not None
        names = ("vibration" if self.vibration else "", "current" if self.current else "", "both" * both)
        return [name for name in names if name]


class MissingLibraryError(SlipwiseError):
    """scikit-learn is not there."""


def fit_experts(windows: Windows, surfaces: Sequence[str], shapes: Sequence[Shape], seed: int) -> Experts:
    """Fit the experts on windows whose labels are among `surfaces`; none where no window has the sensor.

    Raises:
        MissingLibraryError: scikit-learn is not there.
    """
    rows = _thinned(np.flatnonzero(windows.has_vibration), 1, MOST_CENTRES)
    vibration = windows.vibration[rows]
    indicators = (windows.label[rows][:, None] == np.array(surfaces, dtype=object)).astype(np.float64)
    kernels = (
        fit_kernel_expert(vibration, indicators, width=shape.width, ridge=shape.ridge) for shape in shapes
    )
    rows_current = _thinned(np.flatnonzero(windows.has_current), THINNED, MOST_FOR_TREES)
    return Experts(
        tuple(kernels) if len(rows) else (),
        _fit_trees(windows.current[rows_current], windows.label[rows_current], surfaces, seed)
        if len(rows_current)
        else None,
    )


def _thinned(rows: NDArray[np.int64], every: int, most: int) -> NDArray[np.int64]:
    rows = rows[::every]
    if len(rows) <= most:
        return rows
    return rows[np.linspace(0, len(rows) - 1, most).round().astype(np.int64)]


def _fit_trees(
    features: Floats, labels: NDArray[np.object_], surfaces: Sequence[str], seed: int
) -> TreeExpert:
    try:
        from sklearn.ensemble import ExtraTreesClassifier
    except ImportError as error:
        raise MissingLibraryError("scikit-learn is not installed", advice=to_install("terrain")) from error
    forest = ExtraTreesClassifier(
        TREES,
        max_features=FEATURES_TRIED,
        min_samples_leaf=LEAST_IN_LEAF,
        class_weight="balanced",
        random_state=seed,
    )
    forest.fit(features, labels.astype(str))
    columns = [list(surfaces).index(name) for name in forest.classes_]
    return TreeExpert(tuple(_plain(tree.tree_, columns, len(surfaces)) for tree in forest.estimators_))


def _plain(tree: object, columns: Sequence[int], surfaces: int) -> Tree:
    """Return scikit-learn's tree as arrays of its own."""
    nodes = {name: np.asarray(getattr(tree, name)) for name in _NODE_ARRAYS}
    leaf = nodes["children_left"] < 0
    shares = nodes["value"][leaf][:, 0, :]
    leaves = np.zeros((int(leaf.sum()), surfaces))
    leaves[:, columns] = shares / shares.sum(axis=1, keepdims=True)
    left = np.where(leaf, np.cumsum(leaf) - 1, nodes["children_left"])
    threshold = [
        0.0 if end else float(f"{value:.{DIGITS}g}")
        for value, end in zip(nodes["threshold"], leaf, strict=True)
    ]
    return Tree(
        np.where(leaf, LEAF, nodes["feature"]).astype(np.int64),
        np.array(threshold),
        left.astype(np.int64),
        np.where(leaf, 0, nodes["children_right"]).astype(np.int64),
        leaves,
    )


_NODE_ARRAYS = ("children_left", "children_right", "feature", "threshold", "value")
