# SPDX-License-Identifier: Apache-2.0
"""Trains a terrain classifier; whatever is chosen or calibrated is so on runs that were left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError, SettingsError
from slipwise.terrain.calibration import HeldOut, LeftOut, fit_pool
from slipwise.terrain.classifier import UNKNOWN, TerrainClassifier
from slipwise.terrain.experts import Experts, Shape, fit_experts
from slipwise.terrain.recordings import Recording
from slipwise.terrain.scores import Score, score_of
from slipwise.terrain.windows import Cutting, Windows, cut_windows, cutting_of

Floats = NDArray[np.float64]
Progress = Callable[[str, float], None]

OVERLAP = 5  # windows of training begin every fifth of a window
SHAPES = tuple(Shape(width, ridge) for width in (0.3, 0.6) for ridge in (0.05, 0.2))
SHORTEST, LONGEST = 1.0, 5.0  # s
FOLDS = 5
LEAST_RUNS = 2  # of a surface: one to learn from, one to be judged on
LEAST_WINDOWS = 10  # of all surfaces together


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


def usable_windows(windows: Windows) -> tuple[Windows, tuple[str, ...], list[str]]:
    """Return labelled windows of surfaces with enough runs, these surfaces, and what was left out.

    A sensor is used where every surface has it in enough runs.

    Raises:
        LogError: there are fewer than two such surfaces, or one is called "unknown".
    """
    notes = []
    labelled = windows.only(windows.label != "")
    if (labelled.label == UNKNOWN).any():
        raise LogError(f"a surface is called {UNKNOWN}", advice="leave `terrain` empty where it is not known")
    if len(labelled) < len(windows):
        count = len(windows) - len(labelled)
        notes.append(f"left out: {count} windows without a label, or over more than one surface")
    runs = {name: len(set(labelled.run[labelled.label == name])) for name in set(labelled.label.tolist())}
    few = sorted(name for name, count in runs.items() if count < LEAST_RUNS)
    notes += [f"left out: {name}, which has one run; {LEAST_RUNS} at least are needed" for name in few]
    surfaces = tuple(sorted(set(runs) - set(few)))
    if len(surfaces) < 2:
        raise LogError(
            f"{len(surfaces)} surfaces with {LEAST_RUNS} runs or more; two are needed",
            advice="give logs with a column `terrain` and several runs over each surface",
        )
    kept = labelled.only(np.isin(labelled.label.astype(str), surfaces))
    kept = _without_rare_sensors(kept, surfaces, notes)
    if len(kept) < LEAST_WINDOWS:
        raise LogError(f"{len(kept)} windows to train on", advice="give longer logs, or --window 1")
    return kept, surfaces, notes


def folds_of(windows: Windows, surfaces: Sequence[str], seed: int) -> list[NDArray[np.bool_]]:
    """Deal the runs of each surface to folds, so that each surface is in every fold's rest.

    Returns:
        For each fold the windows that it leaves out, [N].
    """
    rng = np.random.default_rng(seed)
    first = dict(zip(windows.run[::-1], windows.label[::-1], strict=True))
    with_imu = set(windows.run[windows.has_vibration])
    fold_of: dict[str, int] = {}
    least = FOLDS
    for name in surfaces:
        runs = sorted(run for run, label in first.items() if label == name)
        rng.shuffle(runs)
        runs.sort(key=lambda run: run not in with_imu)
        fold_of |= {run: k for k, run in enumerate(runs)}
        least = min(least, max(len(set(windows.run[windows.label == name])), LEAST_RUNS))
    index = np.array([fold_of[run] % least for run in windows.run], dtype=np.int64)
    folds = [index == k for k in range(least) if (index == k).any()]
    for fold in folds:
        missing = sorted(set(surfaces) - set(windows.label[~fold].tolist()))
        if missing:
            raise LogError(
                f"without one part of the runs there is no {missing[0]}",
                advice="name more runs in the column `run`: each drive its own",
            )
    return folds


def _without_rare_sensors(windows: Windows, surfaces: Sequence[str], notes: list[str]) -> Windows:
    """Blank out a sensor that some surface has in too few runs."""
    columns = {"vibration": windows.vibration, "current": windows.current}
    for kind, has in (("vibration", windows.has_vibration), ("current", windows.has_current)):
        counts = {name: len(set(windows.run[has & (windows.label == name)])) for name in surfaces}
        rare = sorted(name for name, count in counts.items() if count < LEAST_RUNS)
        if rare and has.any():
            notes.append(f"left out: {kind}, which {rare[0]} has in {counts[rare[0]]} runs")
            columns[kind] = np.full_like(columns[kind], np.nan)
    made = Windows(windows.run, windows.start, windows.end, windows.label, **columns)
    return made.only(made.has_vibration | made.has_current)
