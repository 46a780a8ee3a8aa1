# SPDX-License-Identifier: Apache-2.0
"""What a robot tells and is asked: one measurement or one request, in SI units, with its stamp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Twist:
    """A commanded or a measured twist of the body."""

    t: float  # s, stamp of the message
    v: float  # m/s, forward
    omega: float  # rad/s, counter-clockwise
    vy: float = 0.0  # m/s, to the left


class Command(Twist):
    """A command."""

    __slots__ = ()


class Wheels(Twist):
    """What its wheels measure."""

    __slots__ = ()


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


@dataclass(frozen=True, slots=True)
class Gyro:
    """How fast a gyro measured the robot to turn."""

    t: float  # s
    rate: float  # rad/s, counter-clockwise


@dataclass(frozen=True, slots=True)
class Override:
    """Whether an operator drives the robot past its commands."""

    t: float  # s
    active: bool


@dataclass(frozen=True, slots=True)
class Request:
    """A request to the node.

    `apply` hands the parameters learned to others now; `predict` asks for the path of given commands.
    """

    kind: Literal["apply", "predict"]
    content: str = ""  # of a prediction, as JSON: {"horizon": s, "commands": [[t, v, omega], ...]}


@dataclass(frozen=True, slots=True)
class SurfaceCue:
    """A label of the ground, when it comes: its name, or that it changes now."""

    label: str = ""  # empty: it changes, to what is not known


@dataclass(frozen=True, slots=True)
class DriveStart:
    """Facts about a drive that begins after a while or elsewhere."""

    label: str = ""  # name of the surface, if a label names it
    date: str = ""  # ISO, for the table of surfaces


@dataclass(frozen=True, slots=True)
class RunStart:
    """Another recording begins: nothing is joined with what was before."""

    name: str
    drive: DriveStart | None = None  # a drive begins with it; None: the surface is still the one of before


@dataclass(frozen=True, slots=True)
class Unusable:
    """Something came that is no sample: it is counted, and the first of each kind is said."""

    reason: str  # for the count
    text: str  # what to say
    kind: str  # of the sentence


Sample = Command | Wheels | Pose | Gyro | Override | Request | SurfaceCue | RunStart | Unusable
