# SPDX-License-Identifier: Apache-2.0
"""Tables of the settings that change the learned model: keys of users, and constants beside them.

A constant has its default from the core where the core has one. `python benchmarks/sensitivity.py` halves and
doubles each: mean held-out errors of real logs change little or get worse, so that nobody gains by a change.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from slipwise import _core
from slipwise.calibration.keys import key
from slipwise.segments import WindowRules

FARTHEST_SENSOR = 50.0  # m from base_link; more is a wrong unit
LEAST, LARGEST = 1e-9, 1e6  # of a setting in SI units; beyond them the mathematics loses its digits
Positive = Annotated[float, Field(ge=LEAST, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Ratio = Annotated[float, Field(ge=LEAST, le=100.0)]  # of one thing to another, or of a logarithm
Seconds = Annotated[float, Field(ge=1e-6, le=100.0)]  # of a time constant or delay of a drive
Metres = Annotated[float, Field(ge=-FARTHEST_SENSOR, le=FARTHEST_SENSOR)]
AUTO_BASES = tuple(basis.name for basis in _core.HypothesisSettings().bases)
SEGMENT_SECONDS = {"wheel": 1.0, "command": 2.5}  # lag and delay need longer windows to differ from slip

_PRIOR, _IEKF, _NOISE = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
_RULES, _DRIFT, _FORCE = WindowRules(), _core.DriftSettings(), _core.BodyForceSettings()
_JOINT = "joint"
Structure = Literal["joint", "cascaded", "direct", "baseline"]


class Section(BaseModel):
    """A table of the settings file."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class BasisTerms(Section):
    """A slip basis of one's own: terms per channel, such as `V*abs(w)`."""

    lon: list[str] = key([], 'terms of the basis "custom": of the forward slip rate, such as "V*abs(w)"')
    lat: list[str] = key([], "of the sideways slip rate")
    ang: list[str] = key([], "of the angular slip rate")


class PriorTable(Section):
    """What is expected before any data."""

    slip_fraction: Annotated[float, Field(ge=LEAST, le=10.0)] = key(
        _PRIOR.slip_fraction,
        "standard deviation of slip, by the motion; more for a robot that slips by a third and more",
    )
    clock_offset_std: Seconds = _PRIOR.clock_offset_std  # s; also of delays without an actuator model
    time_constant: Seconds = _PRIOR.time_constant  # s, median: of most drives, learned within seconds
    delay: Seconds = _PRIOR.delay  # s, median


class FilterTable(Section):
    """The iterated extended Kalman filter."""

    huber: Positive = (
        _IEKF.huber
    )  # sigma, from where a residual counts for less; half and double predict worse


class NoiseTable(Section):
    """Noise of slip rates and poses; its size is learned."""

    psd_time: list[NotNegative] = Field(list(_NOISE.shape.psd_time), min_length=3, max_length=3)
    psd_motion: list[NotNegative] = Field(list(_NOISE.shape.psd_motion), min_length=3, max_length=3)
    fraction: list[NotNegative] = key(
        list(_NOISE.shape.fraction),
        "slip (lon, lat, ang) that lasts over a segment, by the motion; more where the terrain changes",
        min_length=3,
        max_length=3,
    )
    pose_std_xy: Positive = _NOISE.shape.pose_std_xy  # m; `adapt` corrects it
    pose_std_yaw: Positive = _NOISE.shape.pose_std_yaw  # rad; `adapt` corrects it
    adapt: bool = _NOISE.adapt  # no two robots, floors and localisers have the same noise


Drift = Literal["mean-reverting", "random-walk"]
_DRIFTS = {"mean-reverting": _core.Drift.MeanReverting, "random-walk": _core.Drift.RandomWalk}


class SmoothingTable(Section):
    """Smoothing of slip that changes slowly, with the distance driven."""

    smooth: bool = key(
        False, "true: `slipwise calibrate` writes the slip at each time into smoothed.csv and the report"
    )
    drift: Drift = cast(Drift, {value: name for name, value in _DRIFTS.items()}[_DRIFT.drift])
    length: Positive = _DRIFT.length  # m of driving over which it changes by as much as the prior allows

    def drift_settings(self) -> _core.DriftSettings:
        """Return the core's settings."""
        settings = _core.DriftSettings()
        settings.drift, settings.length = _DRIFTS[self.drift], self.length
        return settings


def _with_joint(structures: list[Structure]) -> list[Structure]:
    if _JOINT not in structures:
        raise ValueError(f"'{_JOINT}' must be among the structures: it is what others are compared with")
    return structures


class AutoTable(Section):
    """What the basis "auto" averages, and the structures that compete: what predicts best is kept anyway."""

    bases: list[str] = Field(list(AUTO_BASES), min_length=1)
    structures: Annotated[list[Structure], AfterValidator(_with_joint)] = [
        "joint",  # slip, lag and delay learned from poses together
        "cascaded",  # from commands, beside wheel speeds (of any basis): the actuator from these, then slip
        "direct",  # from commands: slip and delays, no lag
        "baseline",  # the kinematic baseline: no slip, no lag, no delay
    ]


class SlipDisturbanceTable(Section):
    """How slip differs from what was learned, for some seconds: one of its candidates is none."""

    learn: bool = True


class BodyForceTable(Section):
    """A force that acts on the robot beside its wheels: wind, a towed load, a stuck wheel."""

    frame: Literal["none", "body", "world"] = key(
        "none", 'learn a force beside slip: "body" turns with the robot (a load), "world" does not (wind)'
    )
    time_constant: Annotated[float, Field(ge=1.0, le=1e5)] = (
        600.0  # s, over which it may come and go: a load stays
    )
    std: Ratio = _FORCE.std  # m/m of the drift that it causes per distance driven, rad/m of the turn

    @property
    def learned(self) -> bool:
        """Whether one is to be learned."""
        return self.frame != "none"

    def law(self) -> _core.BodyForceSettings:
        """Return the core's settings; those of no force where none is to be learned."""
        settings = _core.BodyForceSettings()
        settings.time_constant = self.time_constant if self.learned else 0.0
        settings.std = settings.turn_std = self.std
        return settings

    def added_to(self, basis: _core.Basis) -> _core.Basis:
        """Return a basis with the terms of the force, where one is to be learned."""
        if not self.learned:
            return basis
        body = self.frame == "body"
        return _core.with_force(basis, _core.ForceFrame.Body if body else _core.ForceFrame.World)


class ChangeTable(Section):
    """Following a change of terrain."""

    branches: bool = _core.BranchSettings().follow  # filters compete in which slip jumped at different times


class SegmentTable(Section):
    """How the log is cut into segments."""

    length: Positive | None = key(
        None,
        "s; default 1 from wheel speeds, 2.5 from commands: shorter follows a change sooner, longer sees "
        "more of a slow drive",
        example="1.0",
    )
    unknown_after: Positive = key(
        _RULES.unknown_after,
        "s for which the robot holds an input that is not repeated; no segment lies across a longer gap",
    )


class SensorExtrinsicsTable(Section):
    """Where the sensor whose poses the log holds sits on the robot: its pose in base_link (REP-105)."""

    x: Metres = key(0.0, "m: where the pose sensor sits ahead of base_link (REP-105)")
    y: Metres = key(0.0, "m: to the left of it")
    yaw: Annotated[float, Field(ge=-math.pi, le=math.pi)] = key(0.0, "rad: turned to the left")
    learn: bool = key(False, "true: x, y and yaw are a first guess, and become parameters")

    @property
    def pose(self) -> tuple[float, float, float]:
        """The pose (x, y [m], yaw [rad])."""
        return self.x, self.y, self.yaw
