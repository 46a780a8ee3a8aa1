# SPDX-License-Identifier: Apache-2.0
"""Tells surfaces apart by vibration: kernel ridge regression on the indicators of the surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SHARPNESS = 4.0  # of the softmax over indicators, before calibration
NEAREST = 5  # windows of training whose mean distance says how new a window is


@dataclass(frozen=True)
class KernelExpert:
    """Weights of a Gaussian kernel around the windows that were learned."""

    mean: Floats  # [D] of the features
    scale: Floats  # [D]
    width: float  # gamma of exp(-gamma |z - z'|^2)
    centres: Floats  # [N, D] standardised features
    weights: Floats  # [N, K]

    def probabilities(self, features: Floats) -> Floats:
        """Return the probability of each surface, [M, K], for features [M, D]; not calibrated."""
        kernel = np.exp(-self.width * self._distances(features))
        return _softmax(SHARPNESS * (kernel @ self.weights))

    def newness(self, features: Floats) -> Floats:
        """Return the log of the mean squared distance to the nearest windows of training, [M]."""
        squared = np.partition(self._distances(features), NEAREST - 1, axis=1)[:, :NEAREST]
        return np.asarray(np.log(squared.mean(axis=1) * self.width + 1e-6))

    def _distances(self, features: Floats) -> Floats:
        return squared_distances((features - self.mean) / self.scale, self.centres)


def fit_kernel_expert(features: Floats, indicators: Floats, *, width: float, ridge: float) -> KernelExpert:
    """Solve the ridge regression, with rare surfaces weighted by the root of their rarity.

    Args:
        features: [N, D].
        indicators: [N, K], 1 where the window is of the surface, otherwise 0.
        width: gamma times D.
        ridge: added to the kernel's diagonal; larger is smoother.
    """
    mean, scale = features.mean(axis=0), features.std(axis=0)
    scale = np.where(scale > 1e-9, scale, 1.0)
    centres = (features - mean) / scale
    gamma = width / features.shape[1]
    kernel = np.exp(-gamma * squared_distances(centres, centres))
    rarity = np.sqrt((indicators / (indicators.mean(axis=0) * indicators.shape[1])).sum(axis=1))
    target = indicators - 1.0 / indicators.shape[1]
    weights = np.linalg.solve(kernel + np.diag(ridge / rarity), target)
    return KernelExpert(mean, scale, gamma, centres, weights)


def squared_distances(first: Floats, second: Floats) -> Floats:
    """Return the squared distances between rows, [N, M], for [N, D] and [M, D]."""
    squares = (first**2).sum(axis=1)[:, None] + (second**2).sum(axis=1)
    return np.asarray(np.maximum(squares - 2.0 * first @ second.T, 0.0))


def _softmax(scores: Floats) -> Floats:
    raised = np.exp(scores - scores.max(axis=1, keepdims=True))
    return np.asarray(raised / raised.sum(axis=1, keepdims=True))
