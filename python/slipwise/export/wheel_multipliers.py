# SPDX-License-Identifier: Apache-2.0
"""The wheel radius and separation multipliers closest to a learned slip, and by how much they miss."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.options import ExportOptions
from slipwise.models.body_gains import body_twists
from slipwise.models.model import Model


@dataclass(frozen=True, eq=False)
class WheelMultipliers:
    """Factors of the nominal radii and separation, and what they leave over."""

    left_radius: LearnedNumber
    right_radius: LearnedNumber
    separation: LearnedNumber
    speed_gain: LearnedNumber  # body speed per wheel speed, as the log had them
    yaw_gain: LearnedNumber
    residual: tuple[float, float, float]  # RMS over the range: forward, sideways [m/s], yaw [rad/s]


def wheel_multipliers(model: Model, options: ExportOptions) -> WheelMultipliers:
    """Fit body speed = g V and yaw rate = h w (+ k V with a separation) over the range of validity.

    With the wheels' twist V = r (R + L)/2, w = r (R - L)/b, the radius multiplier is g and the separation
    multiplier g/h. Unequal radii turn a robot whose wheels go straight: k = (right - left)/(b g/h). The basis
    edd-2 is matched exactly.

    Raises:
        ModelError: the robot stands, or turns the other way, by the model.
    """
    body = body_twists(model)
    v, w = body.v, body.w
    g, g_by_parameter = body.line(0, v)
    inputs = (w,) if options.wheel_separation is None else (w, v)
    h, h_by_parameter = body.line(2, *inputs)
    if not (g[0] > 0.0 and h[0] > 0.0):
        raise ModelError(
            f"wheels that drive forward move the robot by a factor of {g[0]:.3g}, and turn it by {h[0]:.3g}",
            advice="these must be positive: check the signs of the log and calibrate again",
        )
    numbers = LearnedNumbers(model)
    speed = numbers.of_parameters(float(g[0]), g_by_parameter[0])
    turn, *veers = (
        numbers.of_parameters(float(value), by) for value, by in zip(h, h_by_parameter, strict=True)
    )
    ratio = speed / turn
    half = numbers.exactly(0.0)
    for veer in veers:  # with a separation
        assert options.wheel_separation is not None
        half = veer * ratio * (options.wheel_separation * options.logged_separation_multiplier / 2.0)
    left = np.column_stack((v * g[0], np.zeros_like(v), np.column_stack(inputs) @ h))
    radius = options.logged_radius_multiplier
    forward, sideways, yaw = np.sqrt(np.mean(np.square(body.mean - left), axis=0)).tolist()
    return WheelMultipliers(
        left_radius=(speed + half * -1.0) * radius,
        right_radius=(speed + half) * radius,
        separation=ratio * options.logged_separation_multiplier,
        speed_gain=speed,
        yaw_gain=turn,
        residual=(forward, sideways, yaw),
    )
