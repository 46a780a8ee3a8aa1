# SPDX-License-Identifier: Apache-2.0
"""Examples that a slip surface is learned from: slip rates of held commands, checked."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise.errors import SettingsError

Floats = NDArray[np.float64]

LEAST_REFERENCE = 0.05  # m/s and rad/s; slower drives do not shrink the references further
CHANNELS = ("lon", "lat", "ang")

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class SlipExamples:
    """Slip rates of N segments; made and checked by `slip_examples`."""

    v: Floats  # [N] m/s
    omega: Floats  # [N] rad/s
    slip: Floats  # [N, 3] forward, left [m/s], yaw [rad/s], added to the commanded twist
    std: Floats | None = None  # [N, 3] standard deviations of the slip rates, where they are known

    def __len__(self) -> int:
        return len(self.v)

    def __getitem__(self, places: slice | NDArray[np.int64] | NDArray[np.bool_]) -> SlipExamples:
        """Return some of the examples, by a slice, places or a mask."""
        std = None if self.std is None else self.std[places]
        return SlipExamples(self.v[places], self.omega[places], self.slip[places], std)

    @property
    def duplicates(self) -> int:
        """How many examples repeat an earlier one exactly, drive and slip."""
        rows = np.column_stack((self.v, self.omega, self.slip))
        return len(rows) - len(np.unique(rows, axis=0))

    @property
    def reference(self) -> tuple[float, float]:
        """90th percentiles of |V| [m/s] and |omega| [rad/s], which give priors their units."""
        v, omega = np.quantile(np.abs(self.v), 0.9), np.quantile(np.abs(self.omega), 0.9)
        return max(float(v), LEAST_REFERENCE), max(float(omega), LEAST_REFERENCE)

    def joined(self, other: SlipExamples) -> SlipExamples:
        """Return these examples followed by others.

        Raises:
            SettingsError: one has standard deviations and the other has none.
        """
        if (self.std is None) != (other.std is None):
            raise SettingsError(
                "examples with and without standard deviations cannot be joined",
                advice="give them for all or for none",
            )
        std = None if self.std is None or other.std is None else np.vstack((self.std, other.std))
        return SlipExamples(
            np.concatenate((self.v, other.v)),
            np.concatenate((self.omega, other.omega)),
            np.vstack((self.slip, other.slip)),
            std,
        )


def slip_examples(drive: ArrayLike, slip: ArrayLike, std: ArrayLike | None = None) -> SlipExamples:
    """Check and hold examples.

    Args:
        drive: held (V [m/s], omega [rad/s]) per segment, [N, 2].
        slip: optimised slip rates (m/s, m/s, rad/s) per segment, [N, 3].
        std: their standard deviations, [N, 3].

    Raises:
        SettingsError: a shape is wrong, a number is not finite, a standard deviation is not positive, or
            there is no example.
    """
    drives, slips = _rows(drive, 2, "drives (V, omega)"), _rows(slip, 3, "slip rates")
    stds = None if std is None else _rows(std, 3, "standard deviations")
    if len(slips) != len(drives) or (stds is not None and len(stds) != len(drives)):
        raise SettingsError(
            f"{len(drives)} drives and {len(slips)} slip rates do not match",
            advice="give one row per segment",
        )
    if stds is not None and not (stds > 0.0).all():
        raise SettingsError(
            "a standard deviation of a slip rate is not positive", advice="leave std out where it is unknown"
        )
    v, omega = (np.ascontiguousarray(column) for column in drives.T)
    examples = SlipExamples(v, omega, slips, stds)
    if examples.duplicates:
        _log.warning("%d of %d examples repeat earlier ones and count twice", examples.duplicates, len(v))
    return examples


def _rows(values: ArrayLike, columns: int, what: str) -> Floats:
    try:
        rows = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise SettingsError(f"the {what} are no numbers") from problem
    if rows.ndim != 2 or rows.shape[1] != columns or len(rows) == 0:
        raise SettingsError(f"the {what} have shape {rows.shape}", advice=f"rows of {columns} are needed")
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise SettingsError(
            f"{len(bad)} of the {what} are not finite",
            where=f"first in row {bad[0]}",
            advice="leave such segments out",
        )
    return rows
