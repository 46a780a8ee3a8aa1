# SPDX-License-Identifier: Apache-2.0
"""What differs between two models beyond the uncertainty that they state, in physical units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

from slipwise.errors import ModelError
from slipwise.models.car import curve_gains
from slipwise.models.model import Model
from slipwise.models.parameter_table import PhysicalParameter, physical_parameters
from slipwise.models.schema import AxisShares
from slipwise.models.share_words import AXES, axis_shares
from slipwise.models.slip_words import Gain, whole_gains
from slipwise.models.step_response import rise_times

#: Standard deviations of a difference from which on two models differ.
DIFFERENT = 3.0


@dataclass(frozen=True)
class Difference:
    """One number in two models; None where a model does not have it."""

    name: str
    unit: str
    first: tuple[float, float] | None  # value and standard deviation
    second: tuple[float, float] | None
    least: float = DIFFERENT  # standard deviations from which on it differs

    @property
    def z(self) -> float:
        """Second minus first, in standard deviations of both together; NaN where one is missing."""
        if self.first is None or self.second is None:
            return math.nan
        change, std = self.second[0] - self.first[0], math.hypot(self.first[1], self.second[1])
        if std == 0.0:
            return 0.0 if change == 0.0 else math.copysign(math.inf, change)
        return change / std

    @property
    def different(self) -> bool:
        """Whether both have it, and it differs beyond the reported uncertainty."""
        return abs(self.z) >= self.least


def differences(first: Model, second: Model) -> tuple[Difference, ...]:
    """Compare gains of the body, how soon it follows, and all parameters.

    Gains can be compared whatever the bases are. Slip terms are compared where both have the same ones,
    since a term means something else beside others. So does a delay beside a lag, and slip behind a gain
    of the drive: where drives are described otherwise, only what they do in all is compared.

    Raises:
        ModelError: one was learned from commands, the other from wheel speeds, or one is of a car that is
            commanded by throttle and steering, or whose lags act on its steering.
    """
    if first.content.input != second.content.input:
        raise ModelError(
            f"one model was learned from {first.content.input}s, the other from {second.content.input}s",
            advice="compare models that were learned from the same input",
        )
    if (first.car is None) != (second.car is None):
        raise ModelError(
            "one model takes throttle and steering, the other speeds and yaw rates",
            advice="compare models that were learned from the same input",
        )
    if (first.content.wheelbase is None) != (second.content.wheelbase is None):
        raise ModelError(
            "the lags of one model act on the steering, those of the other on the yaw rate",
            advice="learn both with the wheelbase, or neither",
        )
    rows = [_paired(*gains) for gains in zip(_gains(first), _gains(second), strict=True)]
    rows += [*_step_rows(first, second), *_share_rows(first, second), *_curve_rows(first, second)]
    tables = [{p.name: p for p in _comparable(model, first, second)} for model in (first, second)]
    for name in dict.fromkeys((*tables[0], *tables[1])):
        one, other = (table.get(name) for table in tables)
        unit = (one or other or tables[0][name]).unit
        rows.append(Difference(name, unit, _estimate(one), _estimate(other), _least(name, tables)))
    return tuple(row for row in rows if row.first is not None or row.second is not None)


def same_logs(first: Model, second: Model) -> bool:
    """Whether both have learned from one log: then their errors are alike, and differences look smaller."""
    hashes = [{log.sha256 for log in model.content.provenance.logs} for model in (first, second)]
    return bool(hashes[0] & hashes[1])


def same_terms(first: Model, second: Model) -> bool:
    """Whether both have the same slip terms."""
    slips = [model.content.slip for model in (first, second)]
    return all(getattr(slips[0], name) == getattr(slips[1], name) for name in ("lon", "lat", "ang"))


def same_drive(first: Model, second: Model) -> bool:
    """Whether lags, delays, gains of the drive and the clock of the poses are described alike."""
    drives = [model.table.of("actuator", "clock").names for model in (first, second)]
    return drives[0] == drives[1]


def _comparable(model: Model, first: Model, second: Model) -> tuple[PhysicalParameter, ...]:
    apart: tuple[str, ...] = () if same_terms(first, second) else ("slip", "force")
    if not same_drive(first, second):
        apart = ("slip", "force", "actuator", "clock")
    return tuple(p for p in physical_parameters(model) if p.stage not in apart)


def _gains(model: Model) -> list[tuple[str, Gain | None]]:
    """Gains of the body over what is commanded, or over what the wheels say."""
    gains = whole_gains(model)
    separation = gains.separation if model.content.input == "wheel" else None
    return [
        ("speed gain", gains.speed),
        ("sideways gain", gains.sideways),
        ("yaw-rate gain", gains.yaw_rate),
        ("separation multiplier", separation),
    ]


def _step_rows(first: Model, second: Model) -> list[Difference]:
    """How late each is in all; by the same clock alone."""
    if first.content.clock_offset != second.content.clock_offset:
        return []
    ours, theirs = rise_times(first), rise_times(second)
    names = dict.fromkeys((*ours, *theirs))
    return [Difference(name, "s", ours.get(name), theirs.get(name)) for name in names]


def _share_rows(first: Model, second: Model) -> list[Difference]:
    """What arrives of commands over the log of each."""
    ours, theirs = axis_shares(first), axis_shares(second)
    return [
        Difference(f"share of {AXES[axis][0]}", "-", _share(ours.get(axis)), _share(theirs.get(axis)))
        for axis in AXES
        if axis in ours or axis in theirs
    ]


def _share(said: AxisShares | None) -> tuple[float, float] | None:
    return None if said is None else (said.arrives.value, said.arrives.std)


def _curve_rows(first: Model, second: Model) -> list[Difference]:
    gains = (curve_gains(model.table, model.content.range) for model in (first, second))
    ours, theirs = ({gain.name: gain for gain in each} for each in gains)
    return [
        Difference(name, one.unit, (one.value, one.std), (theirs[name].value, theirs[name].std))
        for name, one in ours.items()
        if name in theirs
    ]


def _paired(first: tuple[str, Gain | None], second: tuple[str, Gain | None]) -> Difference:
    one, other = ((g.value, g.std) if g is not None and g.identified else None for _, g in (first, second))
    return Difference(first[0], "-", one, other)


def _least(name: str, tables: Sequence[Mapping[str, PhysicalParameter]]) -> float:
    """All values of one curve together are said to differ by chance as rarely as one number (Bonferroni)."""
    curve, bracket, _ = name.partition("(")
    if not bracket or not curve.startswith("car."):
        return DIFFERENT
    values = sum(each.startswith(f"{curve}(") for each in {*tables[0], *tables[1]})
    normal = NormalDist()
    return normal.inv_cdf(1.0 - normal.cdf(-DIFFERENT) / values)


def _estimate(parameter: PhysicalParameter | None) -> tuple[float, float] | None:
    return None if parameter is None else (parameter.value, parameter.std)
