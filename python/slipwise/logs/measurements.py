# SPDX-License-Identifier: Apache-2.0
"""What is measured of a robot, or commanded: one of a few kinds, in SI units, each with its stamp."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Twist:
    """A commanded or a measured twist of the body."""

    t: float  # s, stamp of the message
    v: float  # m/s, forward; the throttle of a car that is commanded so
    omega: float  # rad/s, counter-clockwise; the steering of such a car
    vy: float = 0.0  # m/s, to the left


@dataclass(frozen=True, slots=True)
class Command(Twist):
    """A command."""

    ended: bool = False  # zeros of a watchdog that ended the command before, as was given


class Wheels(Twist):
    """What its wheels measure."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class KnownForce:
    """A known force over the robot's mass; it holds until the next one."""

    t: float  # s
    x: float  # m/s^2, along the robot's x axis
    y: float  # m/s^2, to its left


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a sensor measured the robot to be."""

    t: float  # s
    x: float  # m
    y: float  # m
    yaw: float  # rad, counter-clockwise; NaN where the position alone is measured
    std_xy: float | None = None  # m, where the sensor says it
    std_yaw: float | None = None  # rad
    frame: str = ""  # poses of different frames are not compared
    roll: float | None = None  # rad
    pitch: float | None = None  # rad; by REP-103 nose down is positive
    source: str = ""  # that measured it, of several; nothing: the first
    fix: str = ""  # what a satellite receiver says of it, where fixes are distinguished
    z: float | None = None  # m, up; nothing is learned from it


@dataclass(frozen=True, slots=True)
class Reading:
    """What a sensor of one number measured, such as a gyro."""

    t: float  # s
    column: str  # of a tidy log, such as gyro_z: which sensor it is (`logs.readings`)
    value: float  # in the unit of that column


Measurement = Command | Wheels | KnownForce | Pose | Reading  # at one stamp in this order
