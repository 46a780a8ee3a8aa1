# SPDX-License-Identifier: Apache-2.0
"""Settings of learning, from TOML or keywords; defaults that the core has stand in the core alone."""

from __future__ import annotations

import math
import tomllib
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from slipwise import _core, plugins
from slipwise.calibration.live_table import LiveTable
from slipwise.calibration.log_table import LogTable
from slipwise.calibration.source_tables import PoseSourceTable
from slipwise.errors import OlderNames, SettingsError
from slipwise.files import read_whole
from slipwise.logs.options import LogOptions
from slipwise.models.renamed_keys import with_new_keys
from slipwise.models.upgrade import RENAMED_SETTINGS
from slipwise.segments import WindowRules
from slipwise.validation_text import first_problem

MAX_BYTES = 1024 * 1024  # of a settings file
_SEE = "docs/settings.md lists the keys and what they take"
FARTHEST_SENSOR = 50.0  # m from base_link; more is a wrong unit
LEAST, LARGEST = 1e-9, 1e6  # of a setting in SI units; beyond them the mathematics loses its digits
Positive = Annotated[float, Field(ge=LEAST, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0.0, le=LARGEST)]
Ratio = Annotated[float, Field(ge=LEAST, le=100.0)]  # of one thing to another, or of a logarithm
Seconds = Annotated[float, Field(ge=1e-6, le=100.0)]  # of a time constant or delay of a drive
Metres = Annotated[float, Field(ge=-FARTHEST_SENSOR, le=FARTHEST_SENSOR)]
AUTO_BASES = tuple(basis.name for basis in _core.HypothesisSettings().bases)
AVERAGE = "average"  # the estimator that weighs bases, each learned by a causal filter
NOMINAL_WHEEL_SEPARATION = 0.6  # m, where the settings do not give it
SEGMENT_SECONDS = {"wheel": 1.0, "command": 2.5}  # lag and delay need longer windows to differ from slip

_PRIOR, _IEKF, _NOISE = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
_RULES, _DRIFT, _FORCE = WindowRules(), _core.DriftSettings(), _core.BodyForceSettings()
_JOINT = "joint"
Structure = Literal["joint", "cascaded", "direct", "baseline"]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class BasisTerms(_Section):
    """A slip basis of one's own: terms per channel, such as `V*abs(w)`."""

    lon: list[str] = []
    lat: list[str] = []
    ang: list[str] = []


class PriorTable(_Section):
    """Standard deviations before any data."""

    slip_fraction: Annotated[float, Field(ge=LEAST, le=10.0)] = _PRIOR.slip_fraction
    clock_offset_std: Seconds = _PRIOR.clock_offset_std
    time_constant: Seconds = _PRIOR.time_constant
    delay: Seconds = _PRIOR.delay


class FilterTable(_Section):
    """The iterated extended Kalman filter."""

    huber: Positive = _IEKF.huber


class NoiseTable(_Section):
    """Shape of the noise of slip rates and poses; its size is learned where `adapt` is true."""

    psd_time: list[NotNegative] = Field(list(_NOISE.shape.psd_time), min_length=3, max_length=3)
    psd_motion: list[NotNegative] = Field(list(_NOISE.shape.psd_motion), min_length=3, max_length=3)
    fraction: list[NotNegative] = Field(list(_NOISE.shape.fraction), min_length=3, max_length=3)
    pose_std_xy: Positive = _NOISE.shape.pose_std_xy
    pose_std_yaw: Positive = _NOISE.shape.pose_std_yaw
    adapt: bool = _NOISE.adapt


def _known_estimator(name: str) -> str:
    """Return the name of an estimator.

    Raises:
        SlipwiseError: it comes with a package that is not installed.
    """
    if name == AVERAGE:
        return name
    plugins.refuse_missing(plugins.ESTIMATORS, name)
    known = (AVERAGE, *plugins.added(plugins.ESTIMATORS))
    if name not in known:
        raise ValueError(f"unknown estimator '{name}'; known are {', '.join(known)}")
    return name


Drift = Literal["mean-reverting", "random-walk"]
_DRIFTS = {"mean-reverting": _core.Drift.MeanReverting, "random-walk": _core.Drift.RandomWalk}


class SmoothingTable(_Section):
    """Smoothing of slip that changes slowly, with the distance driven."""

    smooth: bool = False
    drift: Drift = cast(Drift, {value: name for name, value in _DRIFTS.items()}[_DRIFT.drift])
    length: Positive = _DRIFT.length

    def drift_settings(self) -> _core.DriftSettings:
        """Return the core's settings."""
        settings = _core.DriftSettings()
        settings.drift, settings.length = _DRIFTS[self.drift], self.length
        return settings


def _with_joint(structures: list[Structure]) -> list[Structure]:
    if _JOINT not in structures:
        raise ValueError(f"'{_JOINT}' must be among the structures: it is what others are compared with")
    return structures


class AutoTable(_Section):
    """What the basis "auto" averages, and the structures that compete."""

    bases: list[str] = Field(list(AUTO_BASES), min_length=1)
    structures: Annotated[list[Structure], AfterValidator(_with_joint)] = [
        "joint",  # slip, lag and delay learned from poses together
        "cascaded",  # from commands, where wheel speeds are logged: the actuator from these, slip behind it
        "direct",  # from commands: slip and delays, no lag
        "baseline",  # the kinematic baseline: no slip, no lag, no delay
    ]


class SlipDisturbanceTable(_Section):
    """How slip differs from what was learned, for some seconds."""

    learn: bool = True


class BodyForceTable(_Section):
    """A force that acts on the robot beside its wheels: wind, a towed load, a stuck wheel."""

    frame: Literal["none", "body", "world"] = "none"  # what it stays fixed to: the robot, or the poses' frame
    time_constant: Annotated[float, Field(ge=1.0, le=1e5)] = 600.0  # s, over which it may come and go
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


class ChangeTable(_Section):
    """Finding a change of terrain."""

    detect: bool = True


class SegmentTable(_Section):
    """How the log is cut into segments."""

    length: Positive | None = None  # s; None takes the default of the input
    unknown_after: Positive = _RULES.unknown_after


class VehicleTable(_Section):
    """What the log does not say of the robot; the search for limits of its sides and slip ratios use it."""

    # m, between the left and the right wheels
    wheel_separation: Annotated[float, Field(ge=0.01, le=100.0)] = NOMINAL_WHEEL_SEPARATION


class SensorExtrinsicsTable(_Section):
    """Where the sensor whose poses the log holds sits on the robot: its pose in base_link (REP-105)."""

    x: Metres = 0.0  # m, ahead of base_link
    y: Metres = 0.0  # m, to the left of it
    yaw: Annotated[float, Field(ge=-math.pi, le=math.pi)] = 0.0  # rad, turned to the left
    learn: bool = False  # the pose above is a guess to start from; false: it is known

    @property
    def pose(self) -> tuple[float, float, float]:
        """The pose (x, y [m], yaw [rad])."""
        return self.x, self.y, self.yaw


class Settings(_Section):
    """Everything that changes the learned model."""

    basis: str = "auto"  # "auto", "custom" (terms below) or a named basis
    estimator: Annotated[str, AfterValidator(_known_estimator)] = AVERAGE
    terms: BasisTerms = BasisTerms()
    learn_clock_offset: bool = True  # wheel input; from commands the offset is part of the delay
    segment: SegmentTable = SegmentTable()
    prior: PriorTable = PriorTable()
    filter: FilterTable = FilterTable()
    noise: NoiseTable = NoiseTable()
    auto: AutoTable = AutoTable()
    slip_disturbance: SlipDisturbanceTable = SlipDisturbanceTable()
    body_force: BodyForceTable = BodyForceTable()
    change: ChangeTable = ChangeTable()
    smoothing: SmoothingTable = SmoothingTable()
    vehicle: VehicleTable = VehicleTable()
    sensor_extrinsics: SensorExtrinsicsTable = SensorExtrinsicsTable()
    pose_sources: list[PoseSourceTable] = []  # beside the first
    log: LogTable = LogTable()
    live: LiveTable = Field(LiveTable(), exclude=True)  # says nothing of how a log is learned

    def __repr__(self) -> str:
        changed = self.model_dump(exclude_defaults=True)
        return f"Settings({', '.join(f'{name}={value!r}' for name, value in changed.items())})"

    def segment_length(self, input_name: str) -> float:
        """Return the length of the segments to learn from [s]."""
        return self.segment.length or SEGMENT_SECONDS[input_name]

    def rules(self) -> WindowRules:
        """Return the rules of cutting windows."""
        return WindowRules(self.segment.unknown_after, sensor=self.sensor_extrinsics.pose)

    def log_options(self, **given: Any) -> LogOptions:
        """Return the options for `open_log`: those of [log], and `given` ones before them."""
        return self.log.options(self.segment.unknown_after, given)

    def filter_settings(self) -> _core.CausalFilterSettings:
        """Return the core's settings of one causal filter."""
        settings = _core.CausalFilterSettings()
        prior, iekf, noise = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
        _copy(self.prior, prior)
        prior.sensor = _core.Pose2(*self.sensor_extrinsics.pose)
        _copy(self.filter, iekf)
        table = self.noise
        noise.shape = _core.MotionNoise(
            table.psd_time, table.psd_motion, table.fraction, table.pose_std_xy, table.pose_std_yaw
        )
        noise.adapt = table.adapt
        settings.prior, settings.iekf, settings.noise = prior, iekf, noise
        settings.force = self.body_force.law()
        return settings

    def average_settings(self) -> _core.ModelAverageSettings:
        """Return the core's settings of model averaging, and of finding a change of terrain.

        Where a force is learned, sudden changes count as force, and no terrain is looked for.
        """
        settings, change = _core.ModelAverageSettings(), _core.ChangeSettings()
        change.detect = self.change.detect and not self.body_force.learned
        settings.change = change
        return settings

    def choosing(self, basis: str | None, estimator: str | None, body_force: str | None = None) -> Settings:
        """Return these settings with another basis or estimator, or a force in a frame, where one is given.

        Raises:
            SettingsError: there is no such estimator or frame.
        """
        given = {"basis": basis, "estimator": estimator}
        content = self.model_dump() | {key: name for key, name in given.items() if name}
        if body_force:
            content["body_force"]["frame"] = body_force
        chosen = make_settings(content)
        return chosen.model_copy(update={"live": self.live})

    def bases(self) -> list[_core.Basis]:
        """Return the bases to learn: several for `auto`, otherwise one.

        Raises:
            SettingsError: a basis or a term is unknown.
        """
        names = self.auto.bases if self.basis == "auto" else [self.basis]
        try:
            return [self._basis(name) for name in names]
        except ValueError as problem:
            raise SettingsError(str(problem), where="basis") from problem

    def _basis(self, name: str) -> _core.Basis:
        if name == "custom":
            if not (self.terms.lon or self.terms.lat or self.terms.ang):
                raise ValueError(
                    'the custom basis has no terms; write some under [terms], such as lon = ["V"]'
                )
            return _core.Basis("custom", self.terms.lon, self.terms.lat, self.terms.ang)
        return _core.Basis("none", [], [], []) if name == "none" else _core.named_basis(name)


def load_settings(path: Path, changes: Mapping[str, Any] | None = None) -> Settings:
    """Read settings from a TOML file; `changes`, nested dictionaries, go before it.

    Raises:
        SettingsError: the file is missing, not TOML, or has an unknown key or a wrong value.
    """
    try:
        content = tomllib.loads(read_whole(path, most=MAX_BYTES, error=SettingsError).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise SettingsError(
            f"not a TOML file: {problem}", where=str(path), advice='write lines like basis = "auto"'
        ) from problem
    return make_settings(merged(content, changes or {}), where=str(path))


def merged(content: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested dictionaries with the changes in them."""
    result = dict(content)
    for key, value in changes.items():
        inner = result.get(key)
        if isinstance(inner, dict) and isinstance(value, dict):
            value = merged(inner, value)
        result[key] = value
    return result


def make_settings(content: dict[str, Any], *, where: str = "settings") -> Settings:
    """Check settings given as nested dictionaries; warns of keys by the names they had before version 0.2.

    Raises:
        SettingsError: a key is unknown or a value is wrong.
    """
    try:
        return Settings.model_validate(_with_new_keys(content, where))
    except ValidationError as problem:
        raise SettingsError(first_problem(problem), where=where, advice=_SEE) from problem


def _with_new_keys(content: dict[str, Any], where: str) -> object:
    """Return the same under the present names of keys; warns of older ones."""
    live = content.get("live")
    moved: list[str] = []
    if isinstance(live, dict) and ("vehicle" in live or isinstance(live.get("memory"), str)):
        live, moved = _older_live(live)
        content = content | {"live": live}
    result = with_new_keys(content, RENAMED_SETTINGS)
    moved += [f"{name} is {new} now" for place, name, new in _RENAMED if name in _table(content, place)]
    if moved:
        warnings.warn(f"{where}: older names of settings: {', '.join(moved)}", OlderNames, stacklevel=3)
    return result


def _older_live(live: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Return [live] of version 0.2 with present keys, and what moved: there `name` was that of the node."""
    live, moved = dict(live), []
    if "vehicle" in live:
        moved = ["live.vehicle is live.name now", *(["live.name is live.node now"] if "name" in live else [])]
        live = {{"vehicle": "name", "name": "node"}.get(key, key): value for key, value in live.items()}
    if isinstance(live.get("memory"), str) and live.get("model", live["memory"]) == live["memory"]:
        live |= {"model": live["memory"], "memory": True}
        moved.append("the model of live.memory is live.model now")
    return live, moved


_RENAMED = [(place, old, new) for place, names in RENAMED_SETTINGS.items() for old, new in names.items()]


def _table(content: dict[str, Any], place: str) -> dict[str, Any]:
    table = content.get(place) if place else content
    return table if isinstance(table, dict) else {}


def _copy(table: _Section, target: object) -> None:
    for name in type(table).model_fields:
        setattr(target, name, getattr(table, name))
