# SPDX-License-Identifier: Apache-2.0
"""Inputs and measurements as they were recorded, checked and in the order of their stamps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.dynamics.dynamics import Dynamics
from slipwise.errors import LogError

Floats = NDArray[np.float64]

FEWEST = 10  # measurements from which anything is learned


@dataclass(frozen=True, eq=False)
class Recorded:
    """One drive."""

    input_t: Floats  # [N] s, rising
    inputs: Floats  # [N, inputs], each held until the next
    t: Floats  # [M] s, rising
    measured: Floats  # [M, measured states]
    left_out: int  # rows that were not used: not finite, not later than the row before, or before any input


def recorded(dynamics: Dynamics, inputs: ArrayLike, measurements: ArrayLike) -> Recorded:
    """Return what was recorded in the order of time.

    Args:
        dynamics: whose inputs and measured states the columns are.
        inputs: [N, 1 + inputs] rows of t [s] and inputs.
        measurements: [M, 1 + measured states] rows of t [s] and measured states.

    Raises:
        LogError: a table has another shape, or there are fewer than ten measurements.
    """
    given, given_out = _table("inputs", inputs, 1 + len(dynamics.inputs))
    seen, seen_out = _table("measurements", measurements, 1 + len(dynamics.measured))
    if len(given):
        early = seen[:, 0] < given[0, 0]
        seen, seen_out = seen[~early], seen_out + int(early.sum())
    if len(given) == 0 or len(seen) < FEWEST:
        raise LogError(
            f"there are {len(given)} inputs and {len(seen)} measurements after the first of them",
            advice=f"it takes {FEWEST} measurements at least; stamps of both must be of one clock",
        )
    return Recorded(given[:, 0], given[:, 1:], seen[:, 0], seen[:, 1:], given_out + seen_out)


def _table(name: str, rows: ArrayLike, columns: int) -> tuple[Floats, int]:
    """Return finite rows in rising order of their stamps, and how many were left out."""
    try:
        table = np.asarray(rows, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise LogError(f"the {name} are no table of numbers") from problem
    if table.ndim != 2 or table.shape[1] != columns:
        raise LogError(
            f"the {name} have shape {table.shape}", advice=f"give rows of {columns} numbers, t [s] first"
        )
    table = table[np.isfinite(table).all(axis=1)]
    table = table[np.argsort(table[:, 0], kind="stable")]
    kept = table[np.diff(table[:, 0], prepend=-np.inf) > 0.0]
    return kept, len(np.asarray(rows)) - len(kept)
