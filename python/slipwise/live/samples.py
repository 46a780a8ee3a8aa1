# SPDX-License-Identifier: Apache-2.0
"""What a robot tells and is asked: a measurement (`logs.measurements`), a label, or a request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from slipwise.live.outputs import Path
from slipwise.logs.measurements import Command, KnownForce, Measurement, Pose, Reading, Twist, Wheels


@dataclass(frozen=True, slots=True)
class Override:
    """Whether an operator drives the robot past its commands."""

    t: float  # s
    active: bool


@dataclass(frozen=True, slots=True)
class Answer:
    """What came of a request."""

    success: bool
    message: str
    path: Path | None = None  # that was predicted


@dataclass(frozen=True, slots=True)
class Request:
    """A request to the node.

    `apply` hands the parameters learned to others now; `predict` asks for the path of given commands;
    `freeze` lets learning rest until `resume`; `save` writes the cache now.
    """

    kind: Literal["apply", "predict", "freeze", "resume", "save"]
    content: str = ""  # of a prediction, as JSON: {"horizon": s, "commands": [[t, v, omega], ...]}
    answer: Callable[[Answer], None] | None = None  # is called with what came of it, by the node's thread


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
    number: int = 1  # how many of it


Stamped = Measurement | Override
Sample = Stamped | Request | SurfaceCue | RunStart | Unusable

__all__ = [
    "Answer",
    "Command",
    "DriveStart",
    "KnownForce",
    "Override",
    "Pose",
    "Reading",
    "Request",
    "RunStart",
    "Sample",
    "Stamped",
    "SurfaceCue",
    "Twist",
    "Unusable",
    "Wheels",
]
