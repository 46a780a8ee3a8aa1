# SPDX-License-Identifier: Apache-2.0
"""Chooses the windows that can be trained on, and deals runs to folds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.terrain.classifier import UNKNOWN
from slipwise.terrain.windows import Windows

FOLDS = 5
LEAST_RUNS = 2  # of a surface: one to learn from, one to be judged on
LEAST_WINDOWS = 10  # of all surfaces together


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
