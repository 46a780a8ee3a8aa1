# SPDX-License-Identifier: Apache-2.0
"""Drives with known limits, and noisy wheel speeds behind them."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.logs.log import Inputs

TRACK = 1.3  # m
CHAIN = _core.ActuatorModel(0.4, 0.25, 0.16, 0.1, 0.0)
NOISE = (0.02, 0.03)  # m/s, rad/s of wheel speeds
FREE = _core.AxisLimits()
SIDES = _core.CommandLimits(FREE, FREE, _core.AxisLimits(0.12, 1.5, 1.2, 2.0), TRACK, 1.0, 1.0)
CHANNELS = _core.CommandLimits(
    _core.AxisLimits(0.1, 1.4, 1.0, 1.8), _core.AxisLimits(0.08, 1.0, 2.0, 3.0), FREE, TRACK, 1.0, 1.0
)


def track_of(commands: Inputs) -> _core.InputHistory:
    """Commands for the core."""
    return _core.InputHistory(commands.t, commands.v, commands.vy, commands.omega)


def wheels_behind(limits: _core.CommandLimits, commands: Inputs, seed: int) -> Inputs:
    """What wheel speeds say at the stamps of the commands."""
    limited = _core.limited_inputs(track_of(commands), limits, _core.RAMP_PIECE)
    drive = _core.actuator_output(limited, CHAIN, commands.t, _core.BodyTwist(0.0, 0.0, 0.0))
    noise = np.random.Generator(np.random.PCG64(seed)).normal(size=drive.shape) * NOISE
    v, omega = np.ascontiguousarray((drive + noise).T)
    return Inputs(t=commands.t, v=v, vy=np.zeros_like(v), omega=omega)


def search(
    limits: _core.CommandLimits, commands: Inputs, seed: int, separation: float = 1.0
) -> _core.LimitSearch:
    """Look for the limits of such a drive."""
    wheels = wheels_behind(limits, commands, seed)
    rows = np.column_stack((wheels.t, wheels.v, wheels.omega))
    record = _core.WheelRecord(track_of(commands), np.ascontiguousarray(rows))
    return _core.find_limits([record], _core.PriorSettings(), separation, _core.LEAST_LIMIT_GAIN, None)
