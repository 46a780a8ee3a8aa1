# SPDX-License-Identifier: Apache-2.0
"""What a user says of a system: its states, inputs and parameters, and how the state moves."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError

Floats = NDArray[np.float64]
Rates = Callable[[Any, Any, Any], Sequence[Any]]
Jacobians = Callable[[Floats, Floats, Floats], tuple[Any, Any]]


@dataclass(frozen=True)
class State:
    """One component of the state.

    Raises:
        SettingsError: a number is not finite or negative, or a measured component has no deviation.
    """

    name: str
    unit: str = ""
    measured: float | None = None  # std of a measurement, in the unit; None: it is not measured
    angle: bool = False  # rad; measurements may differ by whole turns
    noise: float = 0.0  # std of what adds to its rate, in the unit per square root of a second
    start: float = 0.0  # at the first measurement, where it is not measured
    start_std: float = 1.0  # of that

    def __post_init__(self) -> None:
        numbers = (self.noise, self.start_std, 0.0 if self.measured is None else self.measured)
        if not all(math.isfinite(number) and number >= 0.0 for number in (*numbers, abs(self.start))):
            raise SettingsError(
                f"the state {self.name} has a number that is negative or not finite",
                advice="deviations and noise are 0 or more",
            )
        if self.measured == 0.0:
            raise SettingsError(
                f"the state {self.name} is measured without any error",
                advice="give the standard deviation of a measurement, such as 0.02",
            )


@dataclass(frozen=True)
class Parameter:
    """One number that is to be learned, as it is thought to be before.

    Raises:
        SettingsError: the value is not finite, or the deviation not positive.
    """

    name: str
    value: float
    std: float
    unit: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.value) and math.isfinite(self.std) and self.std > 0.0):
            raise SettingsError(
                f"the parameter {self.name} begins at {self.value:g} with a deviation of {self.std:g}",
                advice="give a finite value and how far it may be off, more than 0",
            )


@dataclass(frozen=True, eq=False)
class Dynamics:
    """x' = f(x, u, p) (thesis 2.2): anything whose state has a rate of change, linear in p or nearly so.

    `rates(state, input, parameters)` returns one rate per state. It is called with many states at once: each
    component of `state` and `parameters` may be an array, so that it is written with numpy's functions and
    without `if`. `jacobians`, where they are given, take one state and return ([states, states],
    [states, parameters]); central differences serve without them.

    Raises:
        SettingsError: two names are the same, nothing is measured, or there is not a parameter.
    """

    states: Sequence[State]
    inputs: Sequence[str]
    parameters: Sequence[Parameter]
    rates: Rates
    jacobians: Jacobians | None = None
    longest_step: float = 0.05  # s, of the integrator

    def __post_init__(self) -> None:
        names = [*(s.name for s in self.states), *self.inputs, *(p.name for p in self.parameters)]
        if len(set(names)) != len(names):
            raise SettingsError("two of the names are the same", advice=f"names are {', '.join(names)}")
        if not self.parameters or not any(s.measured is not None for s in self.states):
            raise SettingsError(
                "dynamics need a parameter and a state that is measured",
                advice="give a Parameter, and `measured` (a standard deviation) of one State at least",
            )
        if not (math.isfinite(self.longest_step) and self.longest_step > 0.0):
            raise SettingsError(f"a longest step of {self.longest_step} s", advice="such as 0.05")

    @property
    def measured(self) -> tuple[int, ...]:
        """Places of the states that are measured."""
        return tuple(place for place, state in enumerate(self.states) if state.measured is not None)

    @property
    def measured_names(self) -> tuple[str, ...]:
        """Names of the states that are measured."""
        return tuple(self.states[place].name for place in self.measured)

    def filter_from(self, t: float, mean: Floats, covariance: Floats) -> _core.DynamicsFilter:
        """Return a filter of states and then parameters that knows an estimate at `t` [s].

        Raises:
            ValueError: a size does not fit, or a number is not finite.
        """
        return _core.DynamicsFilter(
            _core.PythonDynamics(self._rates_in_core, self.jacobians),
            self._noise_in_core(),
            self.longest_step,
            t,
            _core.Estimate(mean, covariance),
        )

    def _noise_in_core(self) -> _core.DynamicsNoise:
        measured = [self.states[place] for place in self.measured]
        return _core.DynamicsNoise(
            list(self.measured),
            [state.angle for state in measured],
            np.array([state.measured for state in measured], dtype=np.float64),
            np.array([state.noise**2 for state in self.states], dtype=np.float64),
        )

    def _rates_in_core(self, states: Floats, given: Floats, parameters: Floats) -> Floats:
        """Rates [states, N] of states [states, N] and parameters [parameters, N] under one input."""
        found = self.rates(tuple(states), tuple(given.tolist()), tuple(parameters))
        if len(found) != len(self.states):
            raise SettingsError(
                f"`rates` returned {len(found)} rates for {len(self.states)} states",
                advice="return one for each state, in their order",
            )
        rates = np.empty(states.shape)
        for row, rate in zip(rates, found, strict=True):
            row[:] = rate
        return rates
