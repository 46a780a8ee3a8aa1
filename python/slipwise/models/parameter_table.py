# SPDX-License-Identifier: Apache-2.0
"""All learned numbers of a model: one row each, with one covariance; also in physical units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.models.schema import Parameter, Stage
from slipwise.number_text import estimate_text

if TYPE_CHECKING:
    from slipwise.models.model import Model

Floats = NDArray[np.float64]

#: A parameter is identified where its standard deviation is at most this fraction of it.
IDENTIFIED_FRACTION = 0.3
#: Or, where zero is a meaningful value, at most this: of the motion for slip [-], or in s, m or rad.
NEGLIGIBLE = 0.02
#: Stages whose parameters are the vector that the core takes, in the order of the rows.
VECTOR: tuple[Stage, ...] = ("slip", "force", "actuator", "clock", "sensor")


@dataclass(frozen=True, eq=False)
class ParameterTable:
    """Rows and the covariance over all of them."""

    rows: tuple[Parameter, ...]
    covariance: (
        Floats  # [rows, rows]; of rows that are learned apart, the blocks beside the diagonal are zero
    )

    @cached_property
    def values(self) -> Floats:
        """Values [rows], in the units of the rows."""
        return np.array([row.value for row in self.rows], dtype=np.float64)

    @property
    def names(self) -> list[str]:
        """Names of the rows."""
        return [row.name for row in self.rows]

    def of(self, *stages: Stage) -> ParameterTable:
        """Return the rows of some stages."""
        return self.at([i for i, row in enumerate(self.rows) if row.stage in stages])

    def without(self, *stages: Stage) -> ParameterTable:
        """Return the rows of all other stages."""
        return self.at([i for i, row in enumerate(self.rows) if row.stage not in stages])

    def at(self, places: Sequence[int]) -> ParameterTable:
        """Return some of the rows."""
        return ParameterTable(tuple(self.rows[i] for i in places), self.covariance[np.ix_(places, places)])

    def beside(self, rows: Sequence[Parameter], covariance: Floats) -> ParameterTable:
        """Return the table with further rows, which were learned apart."""
        old, size = len(self.rows), len(self.rows) + len(rows)
        joint = np.zeros((size, size))
        joint[:old, :old] = self.covariance
        joint[old:, old:] = covariance
        return ParameterTable((*self.rows, *rows), joint)

    def moved(self, values: Floats, covariance: Floats) -> ParameterTable:
        """Return the table with other values and another covariance."""
        stds = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        rows = tuple(
            row.model_copy(update={"value": float(value), "std": float(std)})
            for row, value, std in zip(self.rows, values, stds, strict=True)
        )
        return ParameterTable(rows, covariance)

    def with_vector(self, values: Floats, covariance: Floats) -> ParameterTable:
        """Return the table with another mean and covariance of the rows that the core takes as one vector."""
        places = [i for i, row in enumerate(self.rows) if row.stage in VECTOR]
        if np.array_equal(values, self.values[places]):
            return self
        all_values, joint = self.values.copy(), self.covariance.copy()
        all_values[places], joint[np.ix_(places, places)] = values, covariance
        return self.moved(all_values, joint)

    def content(self) -> dict[str, Any]:
        """Return the keys of a model file that hold it."""
        return {"parameters": list(self.rows), "covariance": self.covariance.tolist()}


@dataclass(frozen=True)
class PhysicalParameter:
    """One learned number in a physical unit."""

    name: str  # as in the model file, without `log_`
    value: float
    std: float
    unit: str
    identified: bool  # known to a stated fraction, or known to be negligible
    target_std: float = math.nan  # at which it is identified; NaN: not asked
    stage: Stage = "slip"

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.name} {estimate_text(self.value, self.std)}{unit}"


def stage_of(name: str, force: Sequence[str] = ()) -> Stage:
    """Return the stage of a parameter that the core takes, by its name.

    Args:
        name: of the parameter.
        force: names of the terms that are a force's.
    """
    if name in force:
        return "force"
    if "." in name:
        return "slip"
    if name == "clock_offset":
        return "clock"
    return "sensor" if name.startswith("sensor_") else "actuator"


def physical_name(name: str) -> str:
    """Return the name of a parameter in its physical unit: `delay_v` of `log_delay_v`."""
    return name.removeprefix("log_")


def known(value: float, std: float) -> bool:
    """Whether a value that is never zero is identified."""
    return 0.0 <= std <= IDENTIFIED_FRACTION * abs(value)


def physical_parameters(model: Model) -> tuple[PhysicalParameter, ...]:
    """Return all parameters of a model; values learned as logarithms are in their own units."""
    effects = _effects(model)
    rows = []
    for p, effect in zip(model.table.rows, effects.tolist(), strict=True):
        value, std = p.value, p.std
        name, unit = physical_name(p.name), p.unit.removeprefix("ln ")
        if name != p.name:
            value = math.exp(p.value)
            std = value * p.std
        identified = known(value, std) or std * effect <= NEGLIGIBLE
        target = max(IDENTIFIED_FRACTION * abs(value), NEGLIGIBLE / effect if effect > 0.0 else math.inf)
        rows.append(PhysicalParameter(name, value, std, unit, identified, target, p.stage))
    return tuple(rows)


def _effects(model: Model) -> Floats:
    """What one unit of a parameter does, in the unit of `NEGLIGIBLE`, [rows].

    For a slip term: its largest rate over the range of the log, as a fraction of the fastest motion; for a
    value on a curve, as a fraction of the curve's largest. Infinite where zero is no meaningful value, or
    where the range does not show what the term does.
    """
    from slipwise.models.body_gains import body_twists

    rows = model.table.rows
    effects = np.array([1.0 if _may_be_zero(row.name) else math.inf for row in rows])
    size = model.motion.slip_size
    if size:
        twists = body_twists(model)
        fastest = np.array([np.abs(twists.v).max(), np.abs(twists.v).max(), np.abs(twists.w).max()])
        largest = np.abs(twists.features).max(axis=0)  # [3, size]
        with np.errstate(divide="ignore", invalid="ignore"):
            fraction = np.where(largest > 0.0, largest / fastest[:, None], 0.0).max(axis=0)
        effects[:size] = np.where(fraction > 0.0, fraction, math.inf)
    for curve in {row.name.partition("(")[0] for row in rows if row.at is not None}:
        places = [i for i, row in enumerate(rows) if row.name.startswith(f"{curve}(")]
        highest = np.abs([rows[i].value for i in places]).max()
        effects[places] = 1.0 / highest if highest > 0.0 else math.inf
    return effects


def _may_be_zero(name: str) -> bool:
    return name == "clock_offset" or name.startswith(
        (
            "log_time_constant",
            "log_delay",
            "delay_",
            "slow_fraction",
            "sensor_",
            "car.lag",
            "car.steering_lag",
            "car.delay",
        )
    )
