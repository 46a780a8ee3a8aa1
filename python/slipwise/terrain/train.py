# SPDX-License-Identifier: Apache-2.0
"""Trains a terrain classifier; whatever is chosen or calibrated is so on runs that were left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import SettingsError
from slipwise.terrain.calibration import HeldOut, LeftOut, fit_pool
from slipwise.terrain.classifier import TerrainClassifier
from slipwise.terrain.experts import Experts, Shape, fit_experts
from slipwise.terrain.recordings import Recording
from slipwise.terrain.scores import Score, score_of
from slipwise.terrain.usable_windows import folds_of, usable_windows
from slipwise.terrain.windows import Cutting, Windows, cut_windows, cutting_of

Floats = NDArray[np.float64]
Progress = Callable[[str, float], None]

OVERLAP = 5  # windows of training begin every fifth of a window
SHAPES = tuple(Shape(width, ridge) for width in (0.3, 0.6) for ridge in (0.05, 0.2))
SHORTEST, LONGEST = 1.0, 5.0  # s


@dataclass(frozen=True)
class Training:
    """A classifier, how it did on the runs that each fold left out, and notes."""

    classifier: TerrainClassifier
    scores: dict[str, Score]  # by what a window has
    runs: dict[str, int]  # by surface
    notes: tuple[str, ...]


def train(
    recordings: Sequence[Recording],
    *,
    seconds: float = 5.0,
    seed: int = 0,
    progress: Progress = lambda _what, _share: None,
) -> Training:
    """Cut windows and train on them.

    Args:
        recordings: with labels.
        seconds: of a window, 1 to 5.
        seed: of trees and of the folds.
        progress: called with the current step and its share of the whole.

    Raises:
        LogError: there are fewer than two surfaces with two runs each.
        SettingsError: the windows are too short or too long.
    """
    if not SHORTEST <= seconds <= LONGEST:
        raise SettingsError(
            f"windows of {seconds:g} s", where="--window", advice=f"{SHORTEST:g} to {LONGEST:g} s"
        )
    cutting = cutting_of(recordings, seconds)
    windows = cut_windows(
        recordings, cutting, step=seconds / OVERLAP, progress=lambda share: progress("windows", 0.1 * share)
    )
    return train_windows(windows, cutting, seed=seed, progress=progress)


def train_windows(
    windows: Windows,
    cutting: Cutting,
    *,
    seed: int = 0,
    progress: Progress = lambda _what, _share: None,
) -> Training:
    """Train on windows that are cut already; as `train`.

    Raises:
        LogError: there are fewer than two surfaces with two runs each.
    """
    windows, surfaces, notes = usable_windows(windows)
    folds = folds_of(windows, surfaces, seed)
    fits, done = len(folds) + len(surfaces) * (len(surfaces) > 2) + 1, 0

    def fit(chosen: NDArray[np.bool_], names: tuple[str, ...]) -> Experts:
        nonlocal done
        progress("training", 0.1 + 0.9 * done / fits)
        done += 1
        return fit_experts(windows.only(chosen), names, SHAPES, seed)

    known = LeftOut.empty(len(windows), len(surfaces), len(SHAPES))
    for fold in folds:
        known.fill(fold, fit(~fold, surfaces), windows)
    strangers = []
    for name in surfaces if len(surfaces) > 2 else ():
        others = tuple(other for other in surfaces if other != name)
        strangers.append(LeftOut.empty(len(windows), len(others), len(SHAPES)))
        strangers[-1].fill(windows.label == name, fit(windows.label != name, others), windows)
    if not strangers:
        notes.append("two surfaces: what an unknown one is like cannot be learned, so none is called unknown")
    shape = known.best_shape(windows, surfaces)
    experts = fit_experts(windows, surfaces, (SHAPES[shape],), seed)
    pools, scores = {}, {}
    for kind in experts.kinds():
        held_out = HeldOut(kind, known, tuple(strangers), windows, surfaces)
        pools[kind], probability, rows = fit_pool(held_out, shape)
        scores[kind] = score_of(probability, windows.label[rows], surfaces)
    vibration = experts.vibration[0] if experts.vibration else None
    return Training(
        TerrainClassifier(surfaces, cutting, vibration, experts.current, pools),
        scores,
        {name: len(set(windows.run[windows.label == name])) for name in surfaces},
        tuple(notes),
    )
