# SPDX-License-Identifier: Apache-2.0
"""What a model says about a rover in the terms of its firmware: limits, feed-forward terms, wheels, steering.

All are in SI units and of the robot's frame (x forward, y left, yaw counter-clockwise); where a firmware's y
points to the right, `is_left` is the one place that turns it round.
"""

from __future__ import annotations

from collections.abc import Callable

from slipwise.export.body_limits import slip_gains, strictest
from slipwise.export.learned_number import LearnedNumber, LearnedNumbers
from slipwise.export.measured_limits import Answer, MeasuredLimits, Quantity
from slipwise.export.options import ExportOptions
from slipwise.export.wheel_multipliers import wheel_multipliers
from slipwise.models.body_gains import turning_twists
from slipwise.models.model import Model

_FEEDBACK = (
    "exact where the log was driven by feed-forward alone (P and I at zero), too small a change otherwise"
)


def is_left(y_right: float) -> bool:
    """Whether a place is left of the middle by a y axis that points to the right, as firmwares have it."""
    return -y_right > 0.0


class FirmwareNumbers:
    """Answers for the quantities of a firmware's table by their names."""

    def __init__(self, model: Model, options: ExportOptions) -> None:
        self._model, self._options = model, options
        self.numbers = LearnedNumbers(model.body)
        self._commands = model.content.input == "command"
        self._measured = MeasuredLimits(model, self.numbers)
        self._speed_gain, self._yaw_gain = self._measured.gains

    def answer(self, quantity: str) -> Answer:
        """Return a quantity of the table, or why the model has none."""
        ask: Callable[[], Answer] = getattr(self, f"_{quantity}", None) or getattr(self._measured, quantity)
        return ask()

    def _logged(self, *names: str) -> list[float] | str:
        """Return what the firmware was set to while the log was recorded."""
        missing = [name for name in names if name not in self._options.logged]
        if missing:
            given = " ".join(f"--logged {name}=VALUE" for name in missing)
            return f"it follows from what was in force while the log was recorded: give {given}"
        return [self._options.logged[name] for name in names]

    def _gain(self, gain: LearnedNumber, what: str) -> LearnedNumber | str:
        """Return a gain of what was commanded, where that was learned."""
        if not self._commands:
            return f"a model of wheel speeds does not say what {what} a command reaches"
        if not gain.value > 0.0:
            return "by the model the robot does not move the way it is commanded"
        if not self.numbers.parameters_of(gain):
            return f"the model has no parameter that scales the {what}"
        return gain

    def _scaled(self, name: str, gain: LearnedNumber, what: str, *, inverse: bool = False) -> Answer:
        """Return what was in force, times the fraction of a command that was reached, or by it."""
        logged, found = self._logged(name), self._gain(gain, what)
        if isinstance(logged, str) or isinstance(found, str):
            return found if isinstance(found, str) else str(logged)
        before = self.numbers.exactly(logged[0])
        number = before / found if inverse else before * found
        reached = f"the {what} reached {self.numbers.text(found)} of the commanded"
        return Quantity(number, f"{logged[0]:g} was in force and {reached}; {_FEEDBACK}")

    @property
    def _steers(self) -> bool:
        return self._model.steers or self._options.min_turning_radius is not None

    @property
    def limits_asked(self) -> bool:
        """Whether limits are to be written."""
        return self._options.limits

    def _full_throttle_speed(self) -> Answer:
        learned = self._measured.learned.saturation_v
        if learned and "RO_MAX_THR_SPEED" not in self._options.logged:
            source = "learned limit of the speed, taken to be that of full throttle"
            return Quantity(strictest(learned, self.numbers), source)
        return self._scaled("RO_MAX_THR_SPEED", self._speed_gain, "speed")

    def _yaw_rate_correction(self) -> Answer:
        if self._steers:
            return "RA_MAX_STR_ANG holds that of vehicles that steer, and two would be one too many"
        if not self._commands:
            return self._of_wheels(
                lambda found: found.separation * (1.0 / self._options.logged_separation_multiplier),
                "separation of a robot without slip over that of the wheels; RO_MAX_THR_SPEED is to be the"
                " speed over ground at full throttle",
            )
        before = self._options.logged.get("RO_YAW_RATE_CORR", 1.0)
        yaw = self._gain(self._yaw_gain, "yaw rate")
        if isinstance(yaw, str):
            return yaw
        number, said = self.numbers.exactly(before) / yaw, f"{before:g} was in force"
        if self._is_stated("full_throttle_speed"):
            number, said = number * self._speed_gain, f"{said}, RO_MAX_THR_SPEED changes with it"
        return Quantity(number, f"{said}, and the yaw rate reached {self.numbers.text(yaw)}; {_FEEDBACK}")

    def _is_stated(self, quantity: str) -> bool:
        found = self.answer(quantity)
        return isinstance(found, Quantity) and not self.numbers.objection(found.number)

    def _full_differential_speed(self) -> Answer:
        if self._steers:
            return "it is of vehicles that turn by their wheels' speeds"
        return self._scaled("RD_MAX_THR_YAW_R", self._yaw_gain, "yaw rate")

    def _wheel_separation(self) -> Answer:
        separation = self._options.wheel_separation
        if separation is None or self._steers:
            return "give --wheel-separation for a robot that turns by its wheels' speeds"
        return Quantity(self.numbers.exactly(separation), "nominal, as given: slip is corrected elsewhere")

    def _wheel_base(self) -> Answer:
        base = self._options.wheel_base
        if base is None or self._options.min_turning_radius is None:
            return "give --wheel-base and --min-turning-radius for a vehicle that steers"
        return Quantity(self.numbers.exactly(base), "as given")

    def _turning_radius(self) -> Answer:
        radius = self._options.min_turning_radius
        if radius is None:
            return "give --min-turning-radius for a vehicle that steers"
        speed, yaw_rate = slip_gains(self.numbers, turning_twists(self._model, radius))
        if not (yaw_rate.value > 0.0 and speed.value > 0.0):
            return "by the model the vehicle does not turn the way it is steered"
        if not self.numbers.parameters_of(speed / yaw_rate):
            return "the model has no parameter that changes it"
        return Quantity(speed * radius / yaw_rate, f"{radius:g} m by geometry, with the slip of full lock")

    def _steering_angle(self) -> Answer:
        base, radius = self._options.wheel_base, self._turning_radius()
        if base is None:
            return "give --wheel-base and --min-turning-radius for a vehicle that steers"
        if isinstance(radius, str):
            return radius
        angle = (self.numbers.exactly(base) / radius.number).arctan()
        return Quantity(angle, f"the angle that turns a vehicle without slip so: {radius.source}")

    def _steering_feed_forward(self) -> Answer:
        return self._scaled("ATC_STR_RAT_FF", self._yaw_gain, "yaw rate", inverse=True)

    def _cruise_speed(self) -> Answer:
        found = self._scaled("CRUISE_SPEED", self._speed_gain, "speed")
        return (
            found
            if isinstance(found, str)
            else Quantity(found.number, f"CRUISE_THROTTLE stays; {found.source}")
        )

    def _per_speed(self) -> float | str:
        """Return throttle [%] per commanded speed [m/s], as it was."""
        logged = self._logged("CRUISE_SPEED", "CRUISE_THROTTLE")
        if isinstance(logged, str):
            return logged
        return logged[1] / logged[0]

    def _of_commands(self, what: str, name: str) -> Answer:
        limits, throttle = self._model.limits_section, self._per_speed()
        learned = None if limits is None else getattr(limits.speed, name)
        if learned is None:
            return f"this log shows no {what}"
        if isinstance(throttle, str):
            return throttle
        said = f"learned {what} of commands, by CRUISE_THROTTLE over CRUISE_SPEED as they were"
        return Quantity(self.numbers.limit(learned) * throttle, said)

    def _least_throttle(self) -> Answer:
        return self._of_commands("dead band", "dead_band")

    def _throttle_rate(self) -> Answer:
        limits = self._model.limits_section
        if limits is not None and limits.speed.slew_rate_lag is not None:
            return "the drive limits its acceleration behind its lag, not that of its commands"
        return self._of_commands("limit of acceleration", "slew_rate_up")

    def _first_wheel_radius(self) -> Answer:
        return self._radius("WENC_RADIUS", "WENC_POS_Y")

    def _second_wheel_radius(self) -> Answer:
        return self._radius("WENC2_RADIUS", "WENC2_POS_Y")

    def _radius(self, radius: str, place: str) -> Answer:
        """Return the effective radius of a wheel with an encoder; its y says on which side it is."""
        if self._commands or self._options.wheel_separation is None:
            return "give --wheel-separation and a model learned from wheel speeds"
        logged = self._logged(radius, place)
        if isinstance(logged, str):
            return logged
        if logged[1] == 0.0:
            return f"{place} is 0, which does not say on which side the wheel is"
        left = is_left(logged[1])
        return self._of_wheels(
            lambda found: (found.left_radius if left else found.right_radius) * logged[0],
            f"{logged[0]:g} m was in force, of the {'left' if left else 'right'} wheel",
        )

    def _of_wheels(self, of: Callable[..., LearnedNumber], source: str) -> Answer:
        number = of(wheel_multipliers(self._model, self._options))
        if not self.numbers.parameters_of(number):
            return "the model has no parameter that changes it"
        return Quantity(number, source)
