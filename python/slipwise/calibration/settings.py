# SPDX-License-Identifier: Apache-2.0
"""Settings of learning, from TOML or keywords; defaults that the core has stand in the core alone."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from slipwise import _core
from slipwise.calibration.log_table import LogTable
from slipwise.errors import SettingsError
from slipwise.files import read_whole
from slipwise.logs.options import LogOptions
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
AUTO_BASES = ("none", "edd-2", "drive-5", "full-linear-6", "ipem-9", "odd-even-10")
AVERAGE = "average"  # the estimator that weighs bases, each learned by a causal filter
ESTIMATORS = (AVERAGE, *_core.estimator_names())
WINDOW_SECONDS = {"wheel": 1.0, "command": 2.5}  # lag and delay need longer windows to be told from slip

_PRIOR, _IEKF, _NOISE = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
_ESTIMATORS = _core.EstimatorSettings()
_AVERAGE, _RULES = _core.ModelAverageSettings(), WindowRules()
_CHANGE, _DRIFT = _core.ChangeSettings(), _core.DriftSettings()
_COLOURED = _core.ColouredSlipSettings()
_START = _core.StartPoseSettings()


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
    lag: Seconds = _PRIOR.lag
    delay: Seconds = _PRIOR.delay
    log_std: Annotated[float, Field(ge=1e-3, le=5.0)] = _PRIOR.log_std
    gain_std: Ratio = _PRIOR.gain_std
    slow_share_std: Ratio = _PRIOR.slow_share_std
    slow_lag: Seconds = _PRIOR.slow_lag
    lever_std: Positive = _PRIOR.lever_std
    sensor_yaw_std: Ratio = _PRIOR.sensor_yaw_std


class FilterTable(_Section):
    """The iterated extended Kalman filter."""

    iterations: Annotated[int, Field(ge=1, le=50)] = _IEKF.iterations
    tolerance: Positive = _IEKF.tolerance
    halvings: Annotated[int, Field(ge=0, le=50)] = _IEKF.halvings
    huber: Positive = _IEKF.huber
    gate: Positive = _IEKF.gate


class NoiseTable(_Section):
    """Shape of the noise of slip rates and poses; its size is learned where `adapt` is true."""

    psd_time: list[NotNegative] = Field(list(_NOISE.shape.psd_time), min_length=3, max_length=3)
    psd_motion: list[NotNegative] = Field(list(_NOISE.shape.psd_motion), min_length=3, max_length=3)
    fraction: list[NotNegative] = Field(list(_NOISE.shape.fraction), min_length=3, max_length=3)
    pose_std_xy: Positive = _NOISE.shape.pose_std_xy
    pose_std_yaw: Positive = _NOISE.shape.pose_std_yaw
    adapt: bool = _NOISE.adapt


def _known_estimator(name: str) -> str:
    if name not in ESTIMATORS:
        raise ValueError(f"unknown estimator '{name}'; known are {', '.join(ESTIMATORS)}")
    return name


Jacobian = Literal["exact", "thesis"]


def _name(jacobian: _core.SegmentJacobian) -> Jacobian:
    return cast(Jacobian, jacobian.name.lower())


Drift = Literal["mean-reverting", "random-walk"]
_DRIFTS = {"mean-reverting": _core.Drift.MeanReverting, "random-walk": _core.Drift.RandomWalk}


class SmoothingTable(_Section):
    """Smoothing of slip that changes slowly, with the distance driven."""

    drift: Drift = cast(Drift, {value: name for name, value in _DRIFTS.items()}[_DRIFT.drift])
    length: Positive = _DRIFT.length

    def drift_settings(self) -> _core.DriftSettings:
        """Return the core's settings."""
        settings = _core.DriftSettings()
        settings.drift, settings.length = _DRIFTS[self.drift], self.length
        return settings


class GradientDescentTable(_Section):
    """The thesis's gradient descent (6.12)."""

    learning_rate: Annotated[float, Field(ge=LEAST, le=1.0)] = _ESTIMATORS.gradient_descent.learning_rate
    damping: Positive = _ESTIMATORS.gradient_descent.damping
    jacobian: Jacobian = _name(_ESTIMATORS.gradient_descent.jacobian)


class EkfThesisTable(_Section):
    """The thesis's filter (Table 6.1)."""

    process_std: NotNegative = _ESTIMATORS.ekf_thesis.process_std
    jacobian: Jacobian = _name(_ESTIMATORS.ekf_thesis.jacobian)


class AutoTable(_Section):
    """Averaging of bases by how well they predict."""

    bases: list[str] = Field(list(AUTO_BASES), min_length=1)
    learning_rate: Ratio = _AVERAGE.weighing.learning_rate
    share: Annotated[float, Field(ge=0.0, lt=1.0)] = _AVERAGE.weighing.share
    richest: Annotated[float, Field(gt=0.0, lt=1.0)] = _AVERAGE.richest
    cascade: bool = True  # from commands, where wheel speeds are logged: also try chain and slip in cascade
    direct: bool = True  # from commands: also try without an actuator model, delays alone
    baseline: bool = True  # also try the kinematic baseline: no slip, no lag, no delay
    limits: bool = True  # in cascade: also look for dead-band, top speed and rate limits of the drive


class ColouredTable(_Section):
    """Slip that wanders about what was learned: candidates of how far and how slowly."""

    learn: bool = True
    fractions: list[Positive] = Field(list(_COLOURED.fractions), min_length=1)
    time_constants: list[Positive] = Field(list(_COLOURED.time_constants), min_length=1)
    white: Annotated[float, Field(gt=0.0, lt=1.0)] = _COLOURED.white
    learning_rate: Ratio = _COLOURED.weighing.learning_rate
    share: Annotated[float, Field(ge=0.0, lt=1.0)] = _COLOURED.weighing.share


class StartTable(_Section):
    """Where a prediction starts: candidates of how far back poses tell of it."""

    learn: bool = True
    memories: list[Positive] = Field(list(_START.memories), min_length=1)
    measured: Annotated[float, Field(gt=0.0, lt=1.0)] = _START.measured
    learning_rate: Ratio = _START.weighing.learning_rate
    share: Annotated[float, Field(ge=0.0, lt=1.0)] = _START.weighing.share


class ChangeTable(_Section):
    """Finding a change of ground, and what is forgotten then; without one nothing ever is."""

    detect: bool = _CHANGE.detect
    threshold: Positive = _CHANGE.threshold
    fraction: Positive = _CHANGE.fraction
    forget: Annotated[float, Field(ge=0.0, le=1.0)] = _CHANGE.forget


class WindowTable(_Section):
    """How the log is cut into windows."""

    length: Positive | None = None  # s; None takes the default of the input
    unknown_after: Positive = _RULES.unknown_after
    late_factor: Positive = _RULES.late_factor
    length_tolerance: Positive = _RULES.length_tolerance
    still_speed: Positive = _RULES.still_speed


class VehicleTable(_Section):
    """What the log does not say of the robot; the methods with slip ratios alone need it."""

    track: Annotated[float, Field(ge=0.01, le=100.0)] = (
        _core.NOMINAL_TRACK
    )  # m, between the left and the right wheels


class MountTable(_Section):
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
    """Everything that changes what is learned."""

    basis: str = "auto"  # "auto", "custom" (terms below) or a named basis
    estimator: Annotated[str, AfterValidator(_known_estimator)] = AVERAGE
    terms: BasisTerms = BasisTerms()
    learn_clock_offset: bool = True  # wheel input; from commands the offset is part of the delay
    window: WindowTable = WindowTable()
    prior: PriorTable = PriorTable()
    filter: FilterTable = FilterTable()
    noise: NoiseTable = NoiseTable()
    auto: AutoTable = AutoTable()
    coloured: ColouredTable = ColouredTable()
    start: StartTable = StartTable()
    change: ChangeTable = ChangeTable()
    smoothing: SmoothingTable = SmoothingTable()
    gradient_descent: GradientDescentTable = GradientDescentTable()
    ekf_thesis: EkfThesisTable = EkfThesisTable()
    vehicle: VehicleTable = VehicleTable()
    mount: MountTable = MountTable()
    log: LogTable = LogTable()

    def __repr__(self) -> str:
        changed = self.model_dump(exclude_defaults=True)
        return f"Settings({', '.join(f'{name}={value!r}' for name, value in changed.items())})"

    def window_length(self, input_name: str) -> float:
        """Return the length of the windows to learn from [s]."""
        return self.window.length or WINDOW_SECONDS[input_name]

    def rules(self) -> WindowRules:
        """Return the rules of cutting windows."""
        table = self.window
        return WindowRules(
            table.unknown_after,
            table.late_factor,
            table.length_tolerance,
            table.still_speed,
            sensor=self.mount.pose,
        )

    def log_options(self, **given: Any) -> LogOptions:
        """Return the options for `open_log`: those of [log], and `given` ones before them."""
        return self.log.options(self.window.unknown_after, given)

    def filter_settings(self) -> _core.CausalFilterSettings:
        """Return the core's settings of one causal filter."""
        settings = _core.CausalFilterSettings()
        prior, iekf, noise = _core.PriorSettings(), _core.IekfSettings(), _core.NoiseSettings()
        _copy(self.prior, prior)
        prior.sensor = _core.Pose2(*self.mount.pose)
        _copy(self.filter, iekf)
        table = self.noise
        noise.shape = _core.MotionNoise(
            table.psd_time, table.psd_motion, table.fraction, table.pose_std_xy, table.pose_std_yaw
        )
        noise.adapt = table.adapt
        settings.prior, settings.iekf, settings.noise = prior, iekf, noise
        return settings

    def estimator_settings(self) -> _core.EstimatorSettings:
        """Return the core's settings of the thesis's estimators."""
        settings = _core.EstimatorSettings()
        descent, kalman = _core.GradientDescentSettings(), _core.EkfThesisSettings()
        descent.learning_rate = self.gradient_descent.learning_rate
        descent.damping = self.gradient_descent.damping
        descent.jacobian = _core.SegmentJacobian[self.gradient_descent.jacobian.capitalize()]
        kalman.process_std = self.ekf_thesis.process_std
        kalman.jacobian = _core.SegmentJacobian[self.ekf_thesis.jacobian.capitalize()]
        settings.gradient_descent, settings.ekf_thesis = descent, kalman
        return settings

    def coloured_settings(self) -> _core.ColouredSlipSettings:
        """Return the core's settings of slip that wanders."""
        settings, table = _core.ColouredSlipSettings(), self.coloured
        settings.fractions, settings.time_constants = table.fractions, table.time_constants
        settings.white, settings.weighing = table.white, _weighing(table)
        return settings

    def start_settings(self) -> _core.StartPoseSettings:
        """Return the core's settings of where a prediction starts."""
        settings, table = _core.StartPoseSettings(), self.start
        settings.memories, settings.measured, settings.weighing = (
            table.memories,
            table.measured,
            _weighing(table),
        )
        return settings

    def average_settings(self) -> _core.ModelAverageSettings:
        """Return the core's settings of model averaging, and of finding a change of ground."""
        settings, change = _core.ModelAverageSettings(), _core.ChangeSettings()
        _copy(self.change, change)
        settings.change = change
        settings.weighing, settings.richest = _weighing(self.auto), self.auto.richest
        return settings

    def choosing(self, basis: str | None, estimator: str | None) -> Settings:
        """Return these settings with another basis or estimator, where one is given.

        Raises:
            SettingsError: there is no such estimator.
        """
        given = {"basis": basis, "estimator": estimator}
        return make_settings(self.model_dump() | {key: name for key, name in given.items() if name})

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


def load_settings(path: Path) -> Settings:
    """Read settings from a TOML file.

    Raises:
        SettingsError: the file is missing, not TOML, or has an unknown key or a wrong value.
    """
    try:
        content = tomllib.loads(read_whole(path, most=MAX_BYTES, error=SettingsError).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise SettingsError(
            f"not a TOML file: {problem}", where=str(path), advice='write lines like basis = "auto"'
        ) from problem
    return make_settings(content, where=str(path))


def make_settings(content: dict[str, Any], *, where: str = "settings") -> Settings:
    """Check settings given as nested dictionaries.

    Raises:
        SettingsError: a key is unknown or a value is wrong.
    """
    try:
        return Settings.model_validate(content)
    except ValidationError as problem:
        raise SettingsError(first_problem(problem), where=where, advice=_SEE) from problem


def _weighing(table: AutoTable | ColouredTable | StartTable) -> _core.WeighingSettings:
    settings = _core.WeighingSettings()
    settings.learning_rate, settings.share = table.learning_rate, table.share
    return settings


def _copy(table: _Section, target: object) -> None:
    for name in type(table).model_fields:
        setattr(target, name, getattr(table, name))
