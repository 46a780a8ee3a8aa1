# SPDX-License-Identifier: Apache-2.0
"""What readers find to be wrong with numbers: units of time and angles, the mounting of a sensor, spikes."""

from __future__ import annotations

import numpy as np

from slipwise.logs.findings.finding import Check, Finding
from slipwise.logs.log import Floats

SLOWEST = 10.0  # s between poses
FEWEST_STEPS = 20  # steps; with fewer no such judgement is made
_QUARTER, _QUARTER_DEGREES = 0.5 * np.pi, 90.0  # of a turn


class NotInSeconds(Check):
    """Stamps in another unit than seconds, or that are no times."""

    kind, family = "not-in-seconds", "clocks"
    means = "stamps are in ms, us or ns, or do not go forward"
    shows = "poses are more than 10 s apart, or ten times as many out of order as in order"
    cure = "convert the column `t` to seconds"

    @classmethod
    def by(cls, steps: Floats) -> Finding | None:
        """Say it of steps between poses [s]: no robot is measured every 10 s and slower."""
        usual = float(np.median(steps)) if len(steps) >= FEWEST_STEPS else 0.0
        if usual <= SLOWEST:
            return None
        advice = "stamps must be in seconds, not in ms, us or ns"
        return cls.found(f"poses are {usual:.3g} s apart", advice, evidence=usual)


class AbsurdSpeeds(Check):
    """Inputs most of which no ground robot has."""

    kind, family = "absurd-speeds", "signs and units"
    means = "speeds are in rpm, ticks or mm/s"
    shows = "a tenth of the samples is faster than 100 m/s or rad/s, and far beyond the others"
    cure = "convert speeds to m/s and yaw rates to rad/s"


class TiltInDegrees(Check):
    """Roll and pitch in degrees."""

    kind, family = "tilt-in-degrees", "signs and units"
    means = "roll and pitch are in degrees"
    shows = "as radians the robot would tumble; as degrees it stays below 60"
    cure = "convert them to radians"

    @classmethod
    def of(cls, largest: float) -> Finding:
        """Say how large they get."""
        return cls.found(
            f"roll and pitch look like degrees (up to {largest:.3g}: as radians the robot would tumble)",
            "convert the poses' angles to radians",
            evidence=largest,
        )


class SteeringInDegrees(Check):
    """Steering angles in degrees."""

    kind, family = "steering-in-degrees", "signs and units"
    means = "steering angles are in degrees"
    shows = "a tenth of them is beyond a quarter turn as radians, and none as degrees"
    cure = "convert `cmd_steer` to radians"

    @classmethod
    def by(cls, angles: Floats) -> Finding | None:
        """Say it of steering angles, NaN where there is none."""
        sizes = np.abs(angles[np.isfinite(angles)])
        if len(sizes) < FEWEST_STEPS or np.quantile(sizes, 0.9) <= _QUARTER or sizes.max() > _QUARTER_DEGREES:
            return None
        largest = float(sizes.max())
        return cls.found(
            f"steering angles look like degrees (up to {largest:.3g}: as radians wheels would turn round)",
            "convert them to radians",
            evidence=largest,
        )


class TiltedSensor(Check):
    """A sensor of roll and pitch on its side or upside down."""

    kind, family, spoils = "tilted-sensor", "signs and units", False
    means = "the IMU sits on its side or upside down: its mounting, and no robot on its side"
    shows = "the mean direction that is up"
    cure = "none: it is taken out; correct the static transform from `base_link` to the IMU"

    @classmethod
    def of(cls, sentence: str) -> Finding:
        """Say it in these words."""
        return cls.found(sentence, "Correct the static transform from base_link to the sensor.")


READINGS: tuple[Check, ...] = (
    NotInSeconds(),
    AbsurdSpeeds(),
    TiltInDegrees(),
    SteeringInDegrees(),
    TiltedSensor(),
)
