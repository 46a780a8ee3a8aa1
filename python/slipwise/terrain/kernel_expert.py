# SPDX-License-Identifier: Apache-2.0
"""Tells surfaces apart by vibration: kernel ridge regression on the indicators of the surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

NEAREST = 5  # windows of training whose mean distance says how new a window is


@dataclass(frozen=True)
class KernelExpert:
    """Weights of a Gaussian kernel around the windows that were learned."""

    mean: Floats  # [D] of the features
    scale: Floats  # [D]
    width: float  # gamma of exp(-gamma |z - z'|^2)
    centres: Floats  # [N, D] standardised features
    weights: Floats  # [N, K]

    @cached_property
    def in_core(self) -> _core.KernelExpert:
        """The expert as the core evaluates it."""
        return _core.KernelExpert(self.mean, self.scale, self.width, self.centres, self.weights)

    def probabilities(self, features: Floats) -> Floats:
        """Return the probability of each surface, [M, K], for features [M, D]; not calibrated."""
        return np.asarray(self.in_core.probabilities(features))

    def newness(self, features: Floats) -> Floats:
        """Return the log of the mean squared distance to the nearest windows of training, [M]."""
        return np.asarray(self.in_core.newness(features))


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
    kernel = np.exp(-gamma * _core.squared_distances(centres, centres))
    rarity = np.sqrt((indicators / (indicators.mean(axis=0) * indicators.shape[1])).sum(axis=1))
    target = indicators - 1.0 / indicators.shape[1]
    weights = np.linalg.solve(kernel + np.diag(ridge / rarity), target)
    return KernelExpert(mean, scale, gamma, centres, weights)
