# SPDX-License-Identifier: Apache-2.0
"""Arguments with which what is bound of vehicles works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from slipwise import _core


def _wheel(x: float, y: float, *, trailed: bool = False) -> _core.Wheel:
    return _core.Wheel(x, y, 0.1, 0.0, None, trailed, trailed, (x + 0.05, y) if trailed else None)


def _layout() -> _core.WheelLayout:
    """Two wheels on an axle, and a steered one behind a hinge."""
    wheels = [_wheel(0.0, 0.3), _wheel(0.0, -0.3), _wheel(-1.0, 0.0, trailed=True)]
    return _core.WheelLayout(wheels, 0.02, 0.02, (-0.5, 0.0))


def _car() -> _core.CarCurves:
    curve = _core.KnotCurve([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.1, 0.0, 0.1])
    car = _core.CarCurves(curve, curve, 0.3, 0.1, 0.1, 0.1)
    return car.with_spread(
        0.01 * np.eye(11), np.array([1.0, 0.0, 1.0, 1.0, 0.1, 1.0, 0.5, 0.2, 0.3, 0.2, 0.1])
    )


def _input_spread() -> _core.InputSpread:
    return _car().spread(
        _core.InputHistory(*(np.array([value]) for value in (0.0, 0.5, 0.0, 0.2))), 0.0, None
    )


#: Sound objects by the name of their type.
VEHICLE_OBJECTS: dict[str, Callable[[], Any]] = {
    "Wheel": lambda: _wheel(0.0, 0.3),
    "WheelLayout": _layout,
    "CarCurves": _car,
    "InputSpread": _input_spread,
}

#: Sound arguments by function and parameter.
VEHICLE_ARGUMENTS: dict[str, Callable[[], Any]] = {
    "Wheel.__init__ behind_hinge": lambda: False,
    "WheelLayout.__init__ wheels": lambda: [_wheel(0.0, 0.3), _wheel(0.0, -0.3)],
    "car_twists out": lambda: np.zeros((2, 4, 2)),
    "CarCurves.with_spread covariance": lambda: 0.01 * np.eye(11),
    "CarCurves.with_spread prior_std": lambda: np.ones(11),
    "Wheel.__init__ pivot": lambda: None,
    "WheelLayout.twists hinge": lambda: np.full((3, 2), 0.1),
}
