# SPDX-License-Identifier: Apache-2.0
"""Arguments with which what is bound of terrain works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from slipwise import _core

SURFACES, FEATURES = 2, 16  # of currents


def _tree() -> _core.TerrainTree:
    return _core.TerrainTree([0, -1, -1], [1.0, 0.0, 0.0], [1, 0, 1], [2, 0, 0], np.eye(SURFACES))


def _trees() -> _core.TreeExpert:
    return _core.TreeExpert([_tree()], FEATURES)


def _kernel() -> _core.KernelExpert:
    return _core.KernelExpert(np.zeros(3), np.ones(3), 0.5, np.ones((6, 3)), np.ones((6, SURFACES)))


def _pool() -> _core.ExpertPool:
    return _core.ExpertPool(1.0, 1.0, 0.0, 1.0, 0.0)


def _classifier() -> _core.TerrainClassifier:
    return _core.TerrainClassifier(["ice", "sand"], _kernel(), _trees(), [None, _pool(), _pool(), _pool()])


def _answer() -> _core.TerrainAnswer:
    return _core.TerrainAnswer(["ice", "sand"], np.array([0.5, 0.5]), 0.1)


def _mixed() -> _core.MixedAhead:
    return _core.MixedAhead(
        [1.0],
        np.array([[1.0, 0.0], [0.3, 0.7]]),
        [np.zeros(2), np.ones(2)],
        [np.eye(2)] * 2,
        [np.ones(3)] * 2,
    )


def _slip(value: float) -> _core.SurfaceSlip:
    given = np.full(2, value), 0.01 * np.eye(2), np.zeros((2, 0)), np.zeros(0)
    return _core.SurfaceSlip(*given, (1.0, 0.5), np.ones(3))


TERRAIN_OBJECTS: dict[str, Callable[[], Any]] = {
    "TerrainAnswer": _answer,
    "TerrainTree": _tree,
    "TreeExpert": _trees,
    "KernelExpert": _kernel,
    "ExpertPool": _pool,
    "TerrainClassifier": _classifier,
    "MixedAhead": _mixed,
    "TerrainWatch": lambda: _core.TerrainWatch(_classifier(), (5.0, 100.0, 6.5), 1.0),
}
TERRAIN_ARGUMENTS: dict[str, Callable[[], Any]] = {
    "VibrationBands.features samples": lambda: np.zeros((500, 6)),
    "current_features samples": lambda: np.ones((20, 4)),
    "even_samples times": lambda: np.arange(20.0),
    "even_samples values": lambda: np.ones((20, 2)),
    "even_samples seconds_and_rate": lambda: (2.0, 2.0),
    "squared_distances first": lambda: np.ones((3, 2)),
    "squared_distances second": lambda: np.ones((4, 2)),
    "KernelExpert.__init__ mean": lambda: np.zeros(3),
    "KernelExpert.__init__ scale": lambda: np.ones(3),
    "KernelExpert.__init__ centres": lambda: np.ones((6, 3)),
    "KernelExpert.__init__ weights": lambda: np.ones((6, SURFACES)),
    "KernelExpert.probabilities features": lambda: np.ones((4, 3)),
    "KernelExpert.newness features": lambda: np.ones((4, 3)),
    "TerrainTree.__init__ feature": lambda: [0, -1, -1],
    "TerrainTree.__init__ threshold": lambda: [1.0, 0.0, 0.0],
    "TerrainTree.__init__ left": lambda: [1, 0, 1],
    "TerrainTree.__init__ right": lambda: [2, 0, 0],
    "TerrainTree.__init__ leaves": lambda: np.eye(SURFACES),
    "TreeExpert.__init__ trees": lambda: [_tree()],
    "TreeExpert.__init__ features": lambda: FEATURES,
    "TreeExpert.probabilities features": lambda: np.ones((4, FEATURES)),
    "ExpertPool.pooled by_vibration": lambda: np.full((3, 2), 0.5),
    "ExpertPool.pooled by_current": lambda: np.full((3, 2), 0.5),
    "ExpertPool.unknown probability": lambda: np.full((3, 2), 0.5),
    "ExpertPool.unknown newness_of": lambda: np.zeros(3),
    "doubt_of probability": lambda: np.full((3, 2), 0.5),
    "TerrainAnswer.__init__ classes": lambda: ["ice", "sand"],
    "TerrainAnswer.__init__ probability": lambda: np.array([0.5, 0.5]),
    "TerrainAnswer.__init__ unknown": lambda: 0.1,
    "TerrainClassifier.__init__ surfaces": lambda: ["ice", "sand"],
    "TerrainClassifier.__init__ vibration": lambda: None,
    "TerrainClassifier.__init__ current": _trees,
    "TerrainClassifier.__init__ pools": lambda: [None, _pool(), None, None],
    "TerrainClassifier.answers vibration": lambda: np.zeros((3, 3)),
    "TerrainClassifier.answers current": lambda: np.zeros((3, FEATURES)),
    "TerrainWatch.__init__ seconds_and_rates": lambda: (5.0, 100.0, 6.5),
    "TerrainWatch.push_imu sample": lambda: np.zeros(6).tolist(),
    "TerrainWatch.push_drive sample": lambda: np.zeros(4).tolist(),
    "MixedAhead.__init__ edges": lambda: [1.0],
    "MixedAhead.__init__ probabilities": lambda: np.array([[1.0, 0.0], [0.3, 0.7]]),
    "MixedAhead.__init__ slips": lambda: [np.zeros(2), np.ones(2)],
    "MixedAhead.__init__ covariances": lambda: [np.eye(2), np.eye(2)],
    "MixedAhead.__init__ noise_scales": lambda: [np.ones(3), np.ones(3)],
    "shrunk_prior known": lambda: [_slip(0.1), _slip(0.2)],
    "shrunk_prior first_std": lambda: np.full(2, 0.3),
    "shrunk_prior speeds": lambda: (1.0, 0.5),
    "surfaces_of_class surfaces": lambda: [("ice", [("white", 1.0)])],
    "KnownSurface.__init__ classes": lambda: [("white", 1.0)],
}
