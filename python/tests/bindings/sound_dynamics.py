# SPDX-License-Identifier: Apache-2.0
"""Arguments with which what is bound of a user's dynamics works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from slipwise import _core


def _rates(_states: Any, given: Any, parameters: Any) -> Any:
    return parameters * given[0]


def _dynamics() -> _core.PythonDynamics:
    return _core.PythonDynamics(_rates, None)


def _noise() -> _core.DynamicsNoise:
    return _core.DynamicsNoise([0], [False], np.array([0.1]), np.array([0.1]))


def _start() -> _core.Estimate:
    return _core.Estimate(np.zeros(2), np.eye(2))


def _filter() -> _core.DynamicsFilter:
    """A filter of one state and one parameter that has an input."""
    made = _core.DynamicsFilter(_dynamics(), _noise(), 0.05, 0.0, _start())
    made.push_input(-1.0, np.array([1.0]))
    return made


#: Sound objects by the name of their type.
DYNAMICS_OBJECTS: dict[str, Callable[[], Any]] = {
    "DynamicsModel": _dynamics,
    "PythonDynamics": _dynamics,
    "DynamicsNoise": _noise,
    "DynamicsFilter": _filter,
}

#: Sound arguments by function and parameter.
DYNAMICS_ARGUMENTS: dict[str, Callable[[], Any]] = {
    "PythonDynamics.__init__ rates": lambda: _rates,
    "DynamicsNoise.__init__ measured": lambda: [0],
    "DynamicsNoise.__init__ angle": lambda: [False],
    "DynamicsNoise.__init__ measurement_std": lambda: np.array([0.1]),
    "DynamicsNoise.__init__ psd": lambda: np.array([0.1]),
    "DynamicsFilter.__init__ start": _start,
    "DynamicsFilter.push_input input": lambda: np.array([1.0]),
    "DynamicsFilter.push_measurement measured": lambda: np.array([0.1]),
    "DynamicsFilter.predict times": lambda: [0.5, 1.0],
    "DynamicsFilter.predict t": lambda: np.array([-1.0]),
    "DynamicsFilter.predict inputs": lambda: np.array([[1.0]]),
}
