# SPDX-License-Identifier: Apache-2.0
"""How late the drive is in all, and how much of a step arrives: delay, gain and both lags together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.models.body_gains import gains_at_sides
from slipwise.models.model import Model

Floats = NDArray[np.float64]

RISEN = 1.0 - np.exp(-1.0)  # of a step: a single lag has come so far after its delay and its time constant
SOON = 2.0  # s after a step, when what has arrived is said
_TIMES = np.linspace(0.0, 40.0, 8001)  # s after a step
_CHANGE = 1e-4  # of a parameter, for derivatives


@dataclass(frozen=True)
class StepResponse:
    """What one channel of the drive makes of a step of its command; values with standard deviations."""

    risen: tuple[float, float]  # s until 63 % of what arrives in the end is there; NaN where that is later
    soon: tuple[float, float]  # fraction of the commanded step that has arrived after 2 s


def step_responses(model: Model) -> tuple[StepResponse, StepResponse]:
    """Return the responses of speed and yaw rate."""
    mean, drive = model.mean, model.motion.slip_size
    numbers = _numbers(model, mean)
    by = np.zeros((len(mean), len(numbers)))
    for k in range(drive, len(mean)):
        high, low = mean.copy(), mean.copy()
        high[k] += _CHANGE
        low[k] -= _CHANGE
        by[k] = (_numbers(model, high) - _numbers(model, low)) / (2.0 * _CHANGE)
    std = np.sqrt(np.maximum(np.einsum("kn,kl,ln->n", by, model.covariance, by), 0.0))
    speed, turn = (
        StepResponse(*((float(numbers[i]), float(std[i])) for i in (channel, channel + 2)))
        for channel in (0, 1)
    )
    return speed, turn


def rises(model: Model) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return how long 63 % of a step of speed and of turning take, and the standard deviations [s].

    Of a car that is commanded by throttle and steering they are delay and lag of its curves: what is behind
    these is short.
    """
    if model.car is None:
        speed, turn = (response.risen for response in step_responses(model))
        return speed, turn
    names, covariance = model.table.names, model.table.covariance

    def late(lag: str) -> tuple[float, float]:
        places = [names.index(name) for name in ("car.delay", lag)]
        variance = float(covariance[np.ix_(places, places)].sum())
        return float(model.table.values[places].sum()), max(variance, 0.0) ** 0.5

    return late("car.lag"), late("car.steering_lag")


def rise_times(model: Model) -> dict[str, tuple[float, float]]:
    """Return how long 63 % of a step take, by delay and lags together, and its standard deviation [s].

    These compare where drives are described otherwise. There are none of wheels, or where it was not learned.
    """
    if model.content.input != "command":
        return {}
    turn = "yaw rate" if model.content.wheelbase is None and model.car is None else "steering"
    found = {
        f"63 % of a step of {name}": risen for name, risen in zip(("speed", turn), rises(model), strict=True)
    }
    return {name: risen for name, risen in found.items() if np.isfinite(risen[0]) and risen[1] > 0.0}


def _numbers(model: Model, parameters: Floats) -> Floats:
    """Seconds to 63 % of speed and yaw rate, and what of both has arrived soon, [4]."""
    actuator = model.motion.actuator(parameters)
    delays = np.array([actuator.delay_v, actuator.delay_omega])
    fast = _lagging(actuator.time_constant_v, actuator.time_constant_omega)
    slow = _lagging(actuator.slow_time_constant_v, actuator.slow_time_constant_omega)
    fraction = np.array([actuator.slow_fraction_v, actuator.slow_fraction_omega])
    arrived = (1.0 - fraction) * fast + fraction * slow  # two lags side by side
    soon = [np.interp(SOON - delays[k], _TIMES, arrived[:, k], left=0.0) for k in (0, 1)]
    risen = delays + [_risen(channel) for channel in arrived.T]
    gains = np.array([actuator.gain_v, actuator.gain_omega]) * gains_at_sides(model)
    return np.concatenate((risen, gains * soon))


def _lagging(time_constant_v: float, time_constant_omega: float) -> Floats:
    """Speed and yaw rate after a step of both to 1 that comes without delay, [times, 2]."""
    step = _core.InputHistory(*(np.array([value]) for value in (0.0, 1.0, 0.0, 1.0)))
    lags = _core.ActuatorModel(time_constant_v, time_constant_omega, 0.0, 0.0, 0.0)
    return _core.actuator_output(step, lags, _TIMES, _core.BodyTwist(0.0, 0.0, 0.0))


def _risen(arrived: Floats) -> float:
    """When 63 % are there for the first time [s]; NaN where they never are."""
    there = arrived >= RISEN
    if not there.any():
        return float("nan")
    k = int(np.argmax(there))
    if k == 0:
        return 0.0
    part = (RISEN - arrived[k - 1]) / (arrived[k] - arrived[k - 1])
    return float(_TIMES[k - 1] + part * (_TIMES[k] - _TIMES[k - 1]))
