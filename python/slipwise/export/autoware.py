# SPDX-License-Identifier: Apache-2.0
"""Autoware: the scale of its vehicle's speed, and the offset of its steering."""

from __future__ import annotations

from slipwise.errors import ModelError
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.options import ExportOptions
from slipwise.export.parameter_file import Entry, Kept, ParameterFile, stated
from slipwise.models.body_gains import body_twists
from slipwise.models.model import Model

_SPEED, _STEERING = ("speed_scale_factor",), ("steering_offset",)
_NAMES = (
    "speed_scale_factor is of autoware_vehicle_velocity_converter, steering_offset of the vehicle's\n"
    "interface (as in pacmod_interface: the steering is asked for the tyre's angle less the offset).\n"
    "x forward, y left."
)


def autoware(model: Model, options: ExportOptions) -> ParameterFile:
    """Return what Autoware is to know of a vehicle's reported speed and steering.

    Raises:
        ModelError: the model was not learned from what the wheels reported, or by it the vehicle stands.
    """
    if model.content.input != "wheel":
        raise ModelError(
            "Autoware corrects what the vehicle reports, and this model is from commands",
            advice="calibrate with `--input wheel`",
        )
    body, numbers = body_twists(model), LearnedNumbers(model.body)
    g, g_by = body.line(0, body.v)
    h, h_by = body.line(2, body.w, body.v)
    speed = numbers.of_parameters(float(g[0]), g_by[0])
    veer = numbers.of_parameters(float(h[1]), h_by[1])
    if not speed.value > 0.0:
        raise ModelError(
            f"wheels that drive forward move the vehicle by a factor of {speed.value:.3g}",
            advice="it must be positive: check the signs of the log and calibrate again",
        )
    return ParameterFile(
        node="/**",
        entries=[_scale(speed, numbers), _offset(speed, veer, numbers, options)],
        notes=[_NAMES],
    )


def _scale(speed: LearnedNumber, numbers: LearnedNumbers) -> Entry | Kept:
    if not numbers.parameters_of(speed):
        return Kept(_SPEED, "the model has no parameter that scales the speed")
    meaning = f"[-] {numbers.text(speed)}, speed over ground by the reported one, {_from(speed, numbers)}"
    return stated(_SPEED, speed, meaning, numbers)


def _offset(
    speed: LearnedNumber, veer: LearnedNumber, numbers: LearnedNumbers, options: ExportOptions
) -> Entry | Kept:
    """A vehicle that drives straight by its report turns at a curvature k: its wheels stand at atan(L k)."""
    if options.wheel_base is None:
        return Kept(_STEERING, "an angle needs the wheel base: give --wheel-base")
    if not numbers.parameters_of(veer):
        return Kept(
            _STEERING, "the model has no term that turns a vehicle whose wheels stand straight, such as ang V"
        )
    angle = (veer * options.wheel_base / speed).arctan()
    before = options.logged.get(_STEERING[0], 0.0)
    number = numbers.exactly(before) + angle
    meaning = (
        f"[rad] {numbers.text(number)}, to the left positive, {_from(angle, numbers)};"
        f" {before:g} was in force (--logged steering_offset=VALUE for another)"
    )
    why = numbers.objection(angle)
    return Kept(_STEERING, why) if why else Entry(_STEERING, number.value, meaning)


def _from(number: LearnedNumber, numbers: LearnedNumbers) -> str:
    return f"from {', '.join(numbers.parameters_of(number))}"
