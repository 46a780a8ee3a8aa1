# SPDX-License-Identifier: Apache-2.0
"""The curves of a car commanded by throttle and steering, in a model file and for the core."""

from __future__ import annotations

from slipwise import _core
from slipwise.models.schema import CarSection, KnotCurveSection


def car_section(car: _core.CarCurves) -> CarSection:
    """Return what was learned of a car as the section of a model file."""

    def curve(found: _core.KnotCurve) -> KnotCurveSection:
        return KnotCurveSection(at=list(found.at), value=list(found.value), std=list(found.std))

    return CarSection(
        speed=curve(car.speed),
        curvature=curve(car.curvature),
        lag=car.lag,
        steering_lag=car.steering_lag,
        cornering_drag=car.cornering_drag,
        understeer=car.understeer,
    )


def core_car(section: CarSection) -> _core.CarCurves:
    """Return the curves for the core."""

    def curve(stated: KnotCurveSection) -> _core.KnotCurve:
        return _core.KnotCurve(stated.at, stated.value, stated.std)

    return _core.CarCurves(
        curve(section.speed),
        curve(section.curvature),
        section.lag,
        section.steering_lag,
        section.cornering_drag,
        section.understeer,
    )
