# SPDX-License-Identifier: Apache-2.0
"""The curves of a car commanded by throttle and steering: rows of a model's parameters, and for the core."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from slipwise import _core
from slipwise.models.parameter_table import ParameterTable
from slipwise.models.schema import UNIDENTIFIABLE_RATIO, Finite, NotNegative, Parameter, Range, Section

Floats = NDArray[np.float64]

_CURVES = (("speed", "m/s"), ("curvature", "1/m"))  # by throttle, by steering
_SINGLE = (
    ("car.lag", "s"),  # of the speed
    ("car.steering_lag", "s"),
    ("car.cornering_drag", "s/rad"),
    ("car.understeer", "s^2/m^2"),
    ("car.delay", "s"),
)
#: How sure the single numbers are in files of schema 4, which do not say it: part of the value, and at least.
_OLDER = ((0.3, 0.05), (0.3, 0.05), (0.0, 0.1), (0.0, 0.05))


class KnotCurveSection(Section):
    """A function that is straight between its knots; beyond the last it stays level."""

    at: Annotated[list[Finite], Field(min_length=2)]  # increasing
    value: list[Finite]
    std: list[NotNegative]  # of the values; near the prior's where nothing was driven

    @model_validator(mode="after")
    def _knots_fit(self) -> KnotCurveSection:
        if not len(self.at) == len(self.value) == len(self.std):
            raise ValueError("a curve needs a value and a deviation at each knot")
        if any(low >= high for low, high in pairwise(self.at)):
            raise ValueError("the knots of a curve must increase")
        return self


class CarSection(Section):
    """What throttle and steering in [-1, 1] of a car do; the rest of the model stands behind it."""

    speed: KnotCurveSection  # by throttle [m/s]
    curvature: KnotCurveSection  # by steering [1/m]
    lag: NotNegative  # of the speed [s]
    steering_lag: NotNegative  # [s]
    cornering_drag: NotNegative  # [s/rad]
    understeer: NotNegative  # [s^2/m^2]


def car_rows(car: _core.CarCurves) -> tuple[list[Parameter], Floats]:
    """Return what was learned of a car as rows of a model's parameters, and their covariance."""
    knots = [
        (f"car.{name}({at:g})", unit, float(at))
        for (name, unit), curve in zip(_CURVES, (car.speed, car.curvature), strict=True)
        for at in curve.at
    ]
    places = [*knots, *((name, unit, None) for name, unit in _SINGLE)]
    values = np.array(car.numbers)
    covariance = np.zeros((len(values), len(values))) if car.covariance is None else np.array(car.covariance)
    prior = np.zeros(len(values)) if car.prior_std is None else np.array(car.prior_std)
    variance = np.diag(covariance)
    rows = [
        Parameter(
            name=name,
            stage="car",
            unit=unit,
            value=float(values[i]),
            std=float(np.sqrt(variance[i])),
            prior_std=float(prior[i]),
            identifiable=bool(variance[i] <= UNIDENTIFIABLE_RATIO * prior[i] ** 2),
            at=at,
        )
        for i, (name, unit, at) in enumerate(places)
    ]
    return rows, covariance


def car_of(rows: Sequence[Parameter], covariance: Floats) -> _core.CarCurves | None:
    """Return the car whose curves are among the rows of a model's parameters; None where there is none.

    Raises:
        ValueError: a number of the car is missing or unknown, or the knots of a curve do not increase.
    """
    places = [i for i, row in enumerate(rows) if row.stage == "car"]
    if not places:
        return None
    of_car = [rows[i] for i in places]
    curves = [
        [(row.at, row.value, row.std) for row in of_car if row.name.startswith(f"car.{name}(")]
        for name, _ in _CURVES
    ]
    knots = sum(map(len, curves))
    if [row.name for row in of_car[knots:]] != [name for name, _ in _SINGLE]:
        raise ValueError(f"a car has two curves, then {', '.join(name for name, _ in _SINGLE)}")
    if any(row.value < 0.0 for row in of_car[knots:]):
        raise ValueError("lags, delay, drag and understeer of a car are not negative")
    sections = []
    for curve in curves:
        at, value, std = map(list, zip(*curve, strict=True)) if curve else ([], [], [])
        sections.append(KnotCurveSection(at=at, value=value, std=std))
    speed, curvature = (_core.KnotCurve(each.at, each.value, each.std) for each in sections)
    car = _core.CarCurves(speed, curvature, *(row.value for row in of_car[knots:]))
    prior = np.array([row.prior_std for row in of_car])
    return car.with_spread(np.ascontiguousarray(covariance[np.ix_(places, places)]), prior)


def curve_gains(table: ParameterTable, span: Range) -> list[Parameter]:
    """Return speed per throttle and curvature per steering of a car; none of other models.

    Each is the straight line through zero that fits the curve best over what was driven.
    """
    gains = []
    for name, unit, driven, by in (
        ("speed", "m/s", span.throttle, "throttle"),
        ("curvature", "1/m", span.steering, "steering"),
    ):
        low, high = driven or (-1.0, 1.0)
        knots = table.at([i for i, row in enumerate(table.rows) if row.name.startswith(f"car.{name}(")])
        inside = knots.at([i for i, row in enumerate(knots.rows) if row.at and low <= row.at <= high])
        if not inside.rows:
            continue
        at = np.array([row.at for row in inside.rows], dtype=np.float64)
        weights = at / float(at @ at)
        variance = max(float(weights @ inside.covariance @ weights), 0.0)
        prior = float(np.abs(weights) @ [row.prior_std for row in inside.rows])
        gains.append(
            Parameter(
                name=f"{name} per {by}",
                stage="car",
                unit=unit,
                value=float(weights @ inside.values),
                std=variance**0.5,
                prior_std=prior,
                identifiable=variance <= UNIDENTIFIABLE_RATIO * prior**2,
            )
        )
    return gains


def drawn_cars(
    table: ParameterTable, deviations: tuple[Sequence[_core.CarCurves], float], samples: int, seed: int
) -> list[_core.CarCurves]:
    """Return cars drawn along the `deviations` of the one in the table; lags stay at least zero."""
    cars, step = deviations
    of_car = table.of("car")
    by_direction = (np.array([car.numbers for car in cars]).reshape(len(cars), -1) - of_car.values) / step
    rng = np.random.Generator(np.random.PCG64(seed))
    drawn = of_car.values + rng.standard_normal((samples, len(cars))) @ by_direction
    least = np.array([-np.inf if row.at is not None else 0.0 for row in of_car.rows])
    found = []
    for numbers in np.maximum(drawn, least):
        car = car_of(of_car.moved(numbers, of_car.covariance).rows, of_car.covariance)
        assert car is not None  # there is one in the table
        found.append(car)
    return found


def older_car(section: CarSection) -> _core.CarCurves:
    """Return the car of a file of schema 4: its values are known each by itself, its prior is not stated."""
    speed, curvature = (
        _core.KnotCurve(each.at, each.value, each.std) for each in (section.speed, section.curvature)
    )
    single = (section.lag, section.steering_lag, section.cornering_drag, section.understeer)
    stds = [part * value + least for value, (part, least) in zip(single, _OLDER, strict=True)]
    std = np.array([*section.speed.std, *section.curvature.std, *stds, 0.0])  # none had a delay
    return _core.CarCurves(speed, curvature, *single).with_spread(np.diag(std**2), np.zeros(len(std)))
