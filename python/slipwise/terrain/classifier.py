# SPDX-License-Identifier: Apache-2.0
"""What was learned about surfaces, and its answer for each window: probabilities, or "unknown"."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import ModelError, SettingsError
from slipwise.terrain.kernel_expert import KernelExpert
from slipwise.terrain.pool import Pool, rejection_at
from slipwise.terrain.tree_expert import TreeExpert
from slipwise.terrain.windows import Cutting, Windows

Floats = NDArray[np.float64]

UNKNOWN = "unknown"
KINDS = np.array(["", "current", "vibration", "both"], dtype=object)  # of windows, as the core counts them


@dataclass(frozen=True)
class TerrainClassifier:
    """Experts for vibration and currents, and how their answers are pooled."""

    surfaces: tuple[str, ...]
    cutting: Cutting
    vibration: KernelExpert | None
    current: TreeExpert | None
    pools: Mapping[str, Pool]  # by what a window has: "vibration", "current" or "both"

    def answer(self, windows: Windows) -> Answer:
        """Return what each window says, with all the sensors that it has.

        Raises:
            ModelError: no window has a measurement that the classifier was trained with.
        """
        found = self.in_core.answers(windows.vibration, windows.current)
        if len(windows) and not any(found.kind):
            raise ModelError(
                "the log has none of the sensors that the classifier was trained with",
                advice=f"it knows {' and '.join(sorted(self.pools))}",
            )
        return Answer(
            self.surfaces, KINDS[np.asarray(found.kind, dtype=np.int64)], found.probability, found.unknown
        )

    @cached_property
    def in_core(self) -> _core.TerrainClassifier:
        """The classifier as the core evaluates it."""
        pools = [self.pools[kind].in_core if kind in self.pools else None for kind in KINDS]
        vibration, current = self.vibration, self.current
        return _core.TerrainClassifier(
            list(self.surfaces),
            None if vibration is None else vibration.in_core,
            None if current is None else current.in_core,
            pools,
        )

    def labels(self, answer: Answer, share: float) -> NDArray[np.object_]:
        """Return the most probable surface of each window, or "unknown"; empty without a measurement.

        Args:
            answer: of `answer`.
            share: which share of windows of unknown surfaces to call unknown; 0 calls none so.

        Raises:
            SettingsError: the share is not below 1.
        """
        if not 0.0 <= share < 1.0:
            raise SettingsError(f"{share:g} is not a share", where="--unknown", advice="from 0 to below 1")
        named = np.array([*self.surfaces, ""], dtype=object)[answer.nearest]
        for kind, pool in self.pools.items():
            if share > 0.0 and pool.rejections:
                bound = rejection_at(pool.rejections, share).bound
                named[(answer.kind == kind) & (answer.unknown >= bound)] = UNKNOWN
        return named


@dataclass(frozen=True)
class Answer:
    """Probabilities for windows; NaN where a window has no measurement that is known."""

    surfaces: tuple[str, ...]
    kind: NDArray[np.object_]  # [N] "vibration", "current", "both", or empty
    probability: Floats  # [N, K] of each surface, if it is one of those that were trained
    unknown: Floats  # [N] that it is none of them, with even prior odds

    @property
    def nearest(self) -> NDArray[np.int64]:
        """Return the most probable surface of each window, [N]; K where nothing is known."""
        known = np.asarray(np.isfinite(self.probability).all(axis=1))
        best = np.where(known[:, None], self.probability, 0.0).argmax(axis=1)
        return np.where(known, best, len(self.surfaces))
