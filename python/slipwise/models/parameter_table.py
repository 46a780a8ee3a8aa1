# SPDX-License-Identifier: Apache-2.0
"""The learned parameters in physical units, and which of them are identified."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise.models.body_gains import body_twists
from slipwise.models.limits import limit_rows
from slipwise.models.model import Model
from slipwise.number_text import estimate_text

#: A parameter is identified where its standard deviation is at most this fraction of it.
IDENTIFIED_FRACTION = 0.3
#: Or, where zero is a meaningful value, at most this: of the motion for slip [-], or in s, m or rad.
NEGLIGIBLE = 0.02


@dataclass(frozen=True)
class PhysicalParameter:
    """One learned number in a physical unit."""

    name: str  # as in the model file, without `log_`
    value: float
    std: float
    unit: str
    identified: bool  # known to a stated fraction, or known to be negligible
    target_std: float = math.nan  # at which it is identified; NaN: not asked

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.name} {estimate_text(self.value, self.std)}{unit}"


def physical_name(name: str) -> str:
    """Return the name of a parameter in its physical unit: `delay_v` of `log_delay_v`."""
    return name.removeprefix("log_")


def known(value: float, std: float) -> bool:
    """Whether a value that is never zero is identified."""
    return 0.0 <= std <= IDENTIFIED_FRACTION * abs(value)


def physical_parameters(model: Model) -> tuple[PhysicalParameter, ...]:
    """Return the parameters and limits of a model; values learned as logarithms are in their own units."""
    effects = _effects(model)
    rows = []
    for p, effect in zip(model.content.parameters, effects.tolist(), strict=True):
        value, std = p.value, p.std
        name, unit = physical_name(p.name), p.unit.removeprefix("ln ")
        if name != p.name:
            value = math.exp(p.value)
            std = value * p.std
        identified = known(value, std) or std * effect <= NEGLIGIBLE
        target = max(IDENTIFIED_FRACTION * abs(value), NEGLIGIBLE / effect if effect > 0.0 else math.inf)
        rows.append(PhysicalParameter(name, value, std, unit, identified, target))
    limits = limit_rows(model.content.limits) if model.content.limits is not None else []
    rows += [
        PhysicalParameter(name, value, std, unit, known(value, std)) for name, value, std, unit in limits
    ]
    return tuple(rows)


def _effects(model: Model) -> NDArray[np.float64]:
    """What one unit of a parameter does, in the unit of `NEGLIGIBLE`, [parameters].

    For a slip term: its largest rate over the range of the log, as a fraction of the fastest motion.
    Infinite where zero is no meaningful value, or where the range does not show what the term does.
    """
    names = [p.name for p in model.content.parameters]
    effects = np.array([1.0 if _may_be_zero(name) else math.inf for name in names])
    size = model.motion.slip_size
    if size:
        twists = body_twists(model)
        fastest = np.array([np.abs(twists.v).max(), np.abs(twists.v).max(), np.abs(twists.w).max()])
        largest = np.abs(twists.features).max(axis=0)  # [3, size]
        with np.errstate(divide="ignore", invalid="ignore"):
            fraction = np.where(largest > 0.0, largest / fastest[:, None], 0.0).max(axis=0)
        effects[:size] = np.where(fraction > 0.0, fraction, math.inf)
    return effects


def _may_be_zero(name: str) -> bool:
    return name == "clock_offset" or name.startswith(
        ("log_time_constant", "log_delay", "delay_", "slow_fraction", "sensor_")
    )
