# SPDX-License-Identifier: Apache-2.0
"""Parameters of rover firmwares as data: which version has which, in which unit, and what it means here."""

from __future__ import annotations

import math
from dataclasses import dataclass

from slipwise.errors import SettingsError

Version = tuple[int, int]

#: What a number in SI units is multiplied by, by the unit that the firmware wants.
_FACTORS = {
    "-": 1.0,
    "m": 1.0,
    "m/s": 1.0,
    "m/s^2": 1.0,
    "rad": 1.0,
    "deg/s": 180.0 / math.pi,
    "deg/s^2": 180.0 / math.pi,
    "%": 1.0,
    "%/s": 1.0,
    "1 per rad/s": 1.0,
}


_LIMITS = {
    "top_speed",
    "top_yaw_rate",
    "acceleration",
    "braking",
    "yaw_acceleration",
    "yaw_braking",
    "throttle_rate",
}


@dataclass(frozen=True)
class FirmwareParameter:
    """One parameter of a firmware."""

    name: str
    unit: str
    quantity: str  # of `firmware_numbers.py`, in SI units
    since: Version  # the first version with this name and meaning
    until: Version | None = None  # the last one; None: it has not gone
    whole: bool = False  # the firmware holds an integer

    @property
    def limit(self) -> bool:
        """Whether it bounds what the vehicle may do: written only where it is asked for."""
        return self.quantity in _LIMITS

    @property
    def factor(self) -> float:
        """What a number in SI units is multiplied by."""
        return _FACTORS[self.unit]

    def valid_in(self, version: Version) -> bool:
        """Whether the version has it."""
        return self.since <= version and (self.until is None or version <= self.until)


@dataclass(frozen=True)
class FirmwareTable:
    """The parameters of one firmware, and the versions that the table was made for."""

    firmware: str
    option: str  # that names the version
    versions: tuple[str, ...]
    parameters: tuple[FirmwareParameter, ...]

    def of_version(self, version: str) -> tuple[FirmwareParameter, ...]:
        """Return the parameters of a version, such as `1.17`.

        Raises:
            SettingsError: the table does not hold that version; none is guessed.
        """
        if version not in self.versions:
            raise SettingsError(
                f"no table of parameters for {self.firmware} {version}",
                where=self.option,
                advice=f"one of {', '.join(self.versions)}; the names differ, so none is guessed",
            )
        major, minor = version.split(".")
        number = (int(major), int(minor))
        return tuple(each for each in self.parameters if each.valid_in(number))


#: Sources: PX4's modules rover_differential and rover_ackermann and their parameter reference. The limits of
#: yaw are in degrees there, the steering angle in radians.
PX4 = FirmwareTable(
    firmware="PX4",
    option="--px4",
    versions=("1.16", "1.17"),
    parameters=(
        FirmwareParameter("RO_MAX_THR_SPEED", "m/s", "full_throttle_speed", (1, 16)),
        FirmwareParameter("RO_YAW_RATE_CORR", "-", "yaw_rate_correction", (1, 17)),
        FirmwareParameter("RD_MAX_THR_YAW_R", "m/s", "full_differential_speed", (1, 16), (1, 16)),
        FirmwareParameter("RO_SPEED_LIM", "m/s", "top_speed", (1, 16)),
        FirmwareParameter("RO_ACCEL_LIM", "m/s^2", "acceleration", (1, 16)),
        FirmwareParameter("RO_DECEL_LIM", "m/s^2", "braking", (1, 16)),
        FirmwareParameter("RO_YAW_RATE_LIM", "deg/s", "top_yaw_rate", (1, 16)),
        FirmwareParameter("RO_YAW_ACCEL_LIM", "deg/s^2", "yaw_acceleration", (1, 16)),
        FirmwareParameter("RO_YAW_DECEL_LIM", "deg/s^2", "yaw_braking", (1, 16)),
        FirmwareParameter("RD_WHEEL_TRACK", "m", "wheel_separation", (1, 16)),
        FirmwareParameter("RA_WHEEL_BASE", "m", "wheel_base", (1, 16)),
        FirmwareParameter("RA_MAX_STR_ANG", "rad", "steering_angle", (1, 16)),
    ),
)

#: Sources: the parameter lists of ArduPilot Rover's releases; AR_AttitudeControl, AP_MotorsUGV and others.
ARDUPILOT = FirmwareTable(
    firmware="ArduPilot Rover",
    option="--ardupilot",
    versions=("4.1", "4.2", "4.3", "4.4", "4.5", "4.6", "4.7"),
    parameters=(
        FirmwareParameter("ATC_STR_RAT_FF", "1 per rad/s", "steering_feed_forward", (4, 1)),
        FirmwareParameter("CRUISE_SPEED", "m/s", "cruise_speed", (4, 1)),
        FirmwareParameter("ATC_ACCEL_MAX", "m/s^2", "acceleration", (4, 1)),
        FirmwareParameter("ATC_DECEL_MAX", "m/s^2", "braking", (4, 1)),
        FirmwareParameter("ATC_STR_RAT_MAX", "deg/s", "top_yaw_rate", (4, 1)),
        FirmwareParameter("ATC_STR_ACC_MAX", "deg/s^2", "yaw_acceleration", (4, 1)),
        FirmwareParameter("ATC_STR_DEC_MAX", "deg/s^2", "yaw_braking", (4, 7)),
        FirmwareParameter("MOT_THR_MIN", "%", "least_throttle", (4, 1), whole=True),
        FirmwareParameter("MOT_SLEWRATE", "%/s", "throttle_rate", (4, 1), whole=True),
        FirmwareParameter("WENC_RADIUS", "m", "first_wheel_radius", (4, 1)),
        FirmwareParameter("WENC2_RADIUS", "m", "second_wheel_radius", (4, 1)),
        FirmwareParameter("TURN_RADIUS", "m", "turning_radius", (4, 1)),
    ),
)
