# SPDX-License-Identifier: Apache-2.0
"""Several sources of poses in one log: which there are, and their poses as one sequence."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from slipwise.logs.log import Poses, Run

Floats = NDArray[np.float64]


def source_names(runs: Iterable[Run]) -> tuple[str, ...]:
    """Return the names of the sources of poses; the first is that of the poses which predictions start from.

    An empty tuple if there is one source whose errors are all of one sort, as in most logs.
    """
    names: dict[str, None] = {}
    fixes: set[float] = set()
    first = ""
    for run in runs:
        first = first or run.source
        names |= dict.fromkeys(run.others)
        fixes |= set(_fixes(run.poses).tolist())
    return (first, *names) if names or len(fixes) > 1 else ()


def sourced_rows(run: Run, poses: Floats, sources: Sequence[str]) -> Floats:
    """Return rows of (t, x, y, yaw, frame, std_xy, std_yaw, source, fix) in the order of their stamps.

    Args:
        run: what was measured.
        poses: rows of the first source, as `recording_rows` returns them.
        sources: all names, the first source's first.
    """
    parts = [np.column_stack((poses, np.zeros(len(poses)), _fixes(run.poses.as_measured)))]
    for number, name in enumerate(sources[1:], start=1):
        if name in run.others:
            other = run.others[name]
            number_of_each = np.full(len(other), float(number))
            parts.append(np.column_stack((pose_rows(other), number_of_each, _fixes(other))))
    rows = np.concatenate(parts)
    return rows[np.argsort(rows[:, 0], kind="stable")]


def pose_rows(poses: Poses) -> Floats:
    """Return poses as rows, see `recording_rows`."""
    deviations = [
        np.zeros(len(poses)) if std is None else np.nan_to_num(std, nan=0.0)
        for std in (poses.std_xy, poses.std_yaw)
    ]
    return np.column_stack((poses.rows(), *deviations))


def _fixes(poses: Poses) -> Floats:
    return np.zeros(len(poses)) if poses.fix is None else np.nan_to_num(poses.fix)
