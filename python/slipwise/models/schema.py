# SPDX-License-Identifier: Apache-2.0
"""The model file: its schema, version and limits. Unknown keys are refused."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from slipwise import _core
from slipwise.models.inputs import InputName
from slipwise.student import LEAST_DOF, MOST_DOF

SCHEMA_VERSION = 5

# posterior / prior variance above which a parameter counts as not identifiable
UNIDENTIFIABLE_RATIO: float = _core.UNIDENTIFIABLE_RATIO
LONGEST_NAME = 80  # characters of the name of a surface
LARGEST = 1e30  # of any number; nothing about a ground robot is larger in SI units


def _refuse_flag(value: object) -> object:
    if isinstance(value, bool):
        raise ValueError("a number is needed, not true or false")
    return value


Number = Annotated[float, BeforeValidator(_refuse_flag)]
Finite = Annotated[Number, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False)]
NotNegative = Annotated[Number, Field(ge=0.0, le=LARGEST, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0.0, le=LARGEST, allow_inf_nan=False)]
Dof = Annotated[Number, Field(ge=LEAST_DOF, le=MOST_DOF, allow_inf_nan=False)]
Triple = Annotated[list[NotNegative], Field(min_length=3, max_length=3)]
Pair = Annotated[list[NotNegative], Field(min_length=2, max_length=2)]
Span = Annotated[list[Finite], Field(min_length=2, max_length=2)]
Stage = Literal["slip", "force", "actuator", "clock", "sensor", "limits", "car", "mount"]


class Section(BaseModel):
    """A part of a model file."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Slip(Section):
    """Terms per channel; slip rates are added to the commanded twist (thesis 3.1)."""

    basis: str
    lon: list[str]
    lat: list[str]
    ang: list[str]


class Parameter(Section):
    """One learned number, in the order of the covariance."""

    name: str
    stage: Stage  # what it belongs to: a stage of the motion, a clock, or where a sensor sits
    unit: str
    value: Finite
    std: NotNegative
    prior_std: NotNegative
    identifiable: bool  # the log says more about it than the prior does
    at: Finite | None = None  # throttle or steering, of a value on a curve
    input: InputName | None = None  # where a model takes both inputs; None: it is of either
    sensor: str = ""  # whose place or clock it is, where that is a further source of poses
    beside: str = ""  # the source beside which it is that, by name
    branch: str = ""  # of the slip, where it has several


class StudentT(Section):
    """What held-out errors of one horizon say of the predicted distribution, a Student t."""

    inflation: Positive  # factor of the covariance [-]
    dof: Dof  # degrees of freedom; few are heavy tails [-]


class Noise(Section):
    """Noise of the slip rates (lon, lat, ang) and poses; `variance_scale` multiplies that of (x, y, yaw)."""

    psd_time: Triple  # white, while moving [m^2/s, m^2/s, rad^2/s]
    psd_motion: Triple  # white, per unit of motion [m^2/m, m^2/m, rad^2/rad]
    fraction: Triple  # constant over a prediction, as a fraction of motion [-]
    pose_std_xy: NotNegative  # [m]
    pose_std_yaw: NotNegative  # [rad]
    variance_scale: Triple  # learned factor of the variances of (x, y, yaw) [-]
    student_t: dict[NotNegative, StudentT] = {}  # by horizon [s]


class DisturbanceCandidate(Section):
    """One guess of the slip disturbance: first-order Gauss-Markov processes of one time constant."""

    linear: NotNegative  # of the forward and sideways terms, as a fraction of their prior std [-]
    angular: NotNegative  # of the angular terms [-]
    time_constant: Positive  # [s]
    weight: NotNegative  # how likely this guess is; all together 1


class SlipDisturbanceSection(Section):
    """The slip disturbance about the parameters, beside the noise."""

    segment: Positive  # length of the segments that say how [s]
    candidates: Annotated[list[DisturbanceCandidate], Field(min_length=1)]

    @model_validator(mode="after")
    def _weights_sum_to_one(self) -> SlipDisturbanceSection:
        total = sum(candidate.weight for candidate in self.candidates)
        if abs(total - 1.0) > 1e-6:
            raise ValueError(f"the weights of the candidates must sum to 1, not {total:.6g}")
        return self


class BodyForceSection(Section):
    """A force that was learned beside slip: some terms are its, and hold for the end of the log."""

    frame: Literal["body", "world"]  # what it stays fixed to: the robot, or the frame of the poses
    time_constant: Positive  # over which it comes and goes [s]
    std: Positive  # of the drift that it causes per distance driven [m/m], and of the turn [rad/m]


class MeasuredBody(Section):
    """What the poses show of the body: rates that 99 % of its motion stayed below, 0 where none was seen."""

    speed: Span  # backward (not above 0), forward [m/s]
    yaw_rate: Span  # to the right (not above 0), to the left [rad/s]
    acceleration: Pair  # away from standstill, towards it [m/s^2], means over half a second
    yaw_acceleration: Pair  # the same [rad/s^2]
    held: Pair  # for how long speeds and yaw rates were asked for, more than 90 % of the time [s]
    seconds: NotNegative  # between the poses that show this; 0: they are too rare


class Range(Section):
    """What the robot did in the log; the model is not known to hold beyond it."""

    speed: Span  # of the inputs [m/s]
    yaw_rate: Span  # of the inputs [rad/s]
    sideways: Span | None = None  # speed to the left, of inputs that have one [m/s]
    throttle: Span | None = None  # of a car; its speeds are then what its curves make of these
    steering: Span | None = None
    curvature: NotNegative | None = (
        None  # of the tightest curves, of a robot that steers; None: not known [1/m]
    )
    slope: NotNegative  # steepest roll or pitch [rad], 0 where it was not measured
    wheel_step: NotNegative = 0.0  # between wheel speeds [s], 0 where there were none
    body: MeasuredBody | None = None  # None: an older slipwise wrote the file, or another estimator learned


class LogReference(Section):
    """A log the model was learned from."""

    path: str
    sha256: str


class Share(Section):
    """What arrives of something, as a fraction."""

    value: Finite
    std: NotNegative  # a tenth of the log left out in turn, and how the fit is made


class AxisShares(Section):
    """What arrives of a commanded speed or yaw rate, as the windows of the log say without a model."""

    windows: Annotated[int, Field(ge=0)]
    arrives: Share  # at the body, of what is commanded
    wheels: Share | None = None  # at the wheels, of what is commanded
    floor: Share | None = None  # at the body, of what the wheels do
    below: NotNegative | None = None  # commands of this size arrive otherwise than larger ones [m/s or rad/s]
    small: Share | None = None  # of these
    large: Share | None = None  # of larger ones
    backward: Share | None = None  # of commands backward or to the right, where these arrive otherwise
    forward: Share | None = None  # of commands ahead or to the left


class Shares(Section):
    """What arrives of commands, by axis."""

    speed: AxisShares | None = None
    yaw_rate: AxisShares | None = None


class Provenance(Section):
    """Where the model comes from."""

    slipwise_version: str
    logs: list[LogReference]
    settings: dict[str, object]
    learned_seconds: NotNegative  # amount of driving learned from [s]
    learned_segments: int
    residuals_per_segment: Positive | None = None  # independent, behind each factor of noise; None: 1
    prior: LogReference | None = None  # the fleet that learning began with
    input_scale: list[Finite] | None = None  # of speed and yaw rate, as the log's were read; None: 1


class HeldOut(Section):
    """Mean errors of predictions that the model had not learned from, beside the kinematic baseline's."""

    horizon: NotNegative  # [s]
    segments: int
    position: NotNegative  # [m]
    heading: NotNegative  # [rad]
    baseline_position: NotNegative  # [m]
    baseline_heading: NotNegative  # [rad]

    @property
    def turns_alone(self) -> bool:
        """Whether turns alone were measured: there is no error of a position, not even the baseline's."""
        return self.segments > 0 and self.position == self.baseline_position == 0.0


class Confounded(Section):
    """Two parameters that the log can hardly tell apart."""

    first: str
    second: str
    correlation: Annotated[Number, Field(ge=-1.000001, le=1.000001, allow_inf_nan=False)]


class VerdictSection(Section):
    """Whether the model may be used, in words."""

    good: bool
    sentence: str
    not_identifiable: list[str] = []
    advice: list[str] = []
    confounded: list[Confounded] = []
    timing: str = ""  # which delay and which clock offset is which
    force: str = ""  # what pushes the robot beside its slip, where that was learned
    reservations: list[str] = []  # sentences that qualify a good verdict
    contradictions: list[str] = []  # between the poses and the inputs of the log: what was learned is no slip
    held_out: HeldOut | None = None

    def __str__(self) -> str:
        return " ".join((self.sentence, *self.advice))


class SurfaceBasis(Section):
    """What one basis knows of a surface, given the robot: what learning goes on from."""

    slip: list[Finite]  # one value per term, where the robot's parameters are `robot`
    covariance: list[list[Finite]]  # of these, were the robot known
    by_robot: list[list[Finite]]  # how they move with the robot's parameters
    robot: list[Finite]
    variance_scale: Triple  # learned factor of the variances of (x, y, yaw) [-]

    @model_validator(mode="after")
    def _shapes_fit(self) -> SurfaceBasis:
        size = len(self.slip)
        if len(self.covariance) != size or any(len(row) != size for row in self.covariance):
            raise ValueError(f"covariance of a basis must have {size} rows of {size} numbers")
        if len(self.by_robot) != size or any(len(row) != len(self.robot) for row in self.by_robot):
            raise ValueError(f"by_robot of a basis must have {size} rows of {len(self.robot)} numbers")
        return self


class SurfaceMemorySection(Section):
    """What a learner goes on from where it comes to the surface again."""

    observed: Annotated[int, Field(ge=0)]  # segments by which bases were weighted
    prior_speeds: Annotated[list[Positive], Field(min_length=2, max_length=2)]  # of the prior [m/s, rad/s]
    weights: dict[str, NotNegative]  # of the bases
    bases: dict[str, SurfaceBasis]

    @model_validator(mode="after")
    def _bases_fit(self) -> SurfaceMemorySection:
        if set(self.weights) != set(self.bases) or not sum(self.weights.values()) > 0.0:
            raise ValueError("the memory of a surface needs a weight for each basis, not all of them 0")
        return self


class LabelSection(Section):
    """What labels of surfaces were worth."""

    all: NotNegative  # labels that were judged by the surface that was then found
    right: NotNegative


class SurfaceSection(Section):
    """The slip of a surface that was driven on; lags, delays and noise are those of the model."""

    name: Annotated[str, Field(min_length=1, max_length=LONGEST_NAME)]
    seconds: NotNegative  # driven on it
    segments: Annotated[int, Field(ge=0)]  # learned on it
    visits: Annotated[int, Field(ge=0)]
    last_seen: str = ""  # date, where it was given
    speed: NotNegative  # below which 90 % of the driving stayed [m/s]
    yaw_rate: NotNegative  # the same [rad/s]
    slip: list[Finite]  # one value per slip parameter, in their order
    covariance: list[list[Finite]]  # of these
    memory: SurfaceMemorySection | None = None  # without it, the surface serves predictions alone
    classes: dict[str, NotNegative] = {}  # of terrain that sensors named on it, in visits

    @model_validator(mode="after")
    def _covariance_fits(self) -> SurfaceSection:
        size = len(self.slip)
        if len(self.covariance) != size or any(len(row) != size for row in self.covariance):
            raise ValueError(f"covariance of a surface must have {size} rows of {size} numbers")
        return self


class ModelFile(Section):
    """Everything that crosses from learning to using."""

    slipwise_model: Literal[5]
    input: InputName
    slip: Slip
    dynamics: bool  # time constants and delays are parameters
    delays: bool = False  # delays without lags, in seconds, are parameters: there is no actuator model
    lags: bool = False  # lags without delays are parameters: of a body behind its wheels
    clock_offset: bool  # the offset between inputs and poses is a parameter
    response: bool = False  # gain and slow mode of the drive are parameters, learned from wheel speeds
    sensor_extrinsics: bool = False  # the pose of the pose sensor in base_link is three parameters
    wheelbase: Positive | None = None  # m, of a robot that steers: lags act on its steering
    limit_gains: Pair | None = None  # of speed and yaw rate behind the drive's limits, where it has some
    parameters: list[Parameter]
    covariance: list[list[Finite]]
    noise: Noise
    slip_disturbance: SlipDisturbanceSection | None = (
        None  # about the parameters; None: it was not looked for
    )
    body_force: BodyForceSection | None = None
    range: Range
    weights: dict[str, NotNegative] = {}
    provenance: Provenance
    verdict: VerdictSection
    surfaces: list[
        SurfaceSection
    ] = []  # that are remembered; the parameters are those of the last one driven
    labels: LabelSection | None = None  # of surfaces, where there are some
    branches: dict[str, NotNegative] = {}  # weights of the branches of the slip
    message: dict[str, str] = {}  # fields of a message that inputs are read from, by axis
    shares: Shares | None = None  # that arrive of what is commanded; None: no commands, or too few windows
    other_input: ModelFile | None = None  # the same robot from its other input, learned from the same logs

    @model_validator(mode="after")
    def _inputs_differ(self) -> ModelFile:
        other = self.other_input
        if other is not None and (other.input == self.input or other.other_input is not None):
            raise ValueError("other_input must be of the input that the model itself is not of")
        return self

    @model_validator(mode="after")
    def _surfaces_have_this_slip(self) -> ModelFile:
        size = len(self.slip.lon) + len(self.slip.lat) + len(self.slip.ang)
        for surface in self.surfaces:
            if len(surface.slip) != size:
                raise ValueError(f"the surface {surface.name!r} needs {size} values, one per slip parameter")
        names = [surface.name for surface in self.surfaces]
        if len(set(names)) < len(names):
            raise ValueError("two surfaces have one name")
        return self

    @model_validator(mode="after")
    def _covariance_fits(self) -> ModelFile:
        size = len(self.parameters)
        if len(self.covariance) != size or any(len(row) != size for row in self.covariance):
            raise ValueError(f"covariance must have {size} rows of {size} numbers, one per parameter")
        return self

    @model_validator(mode="after")
    def _parts_are_alone(self) -> ModelFile:
        if self.delays and (self.dynamics or self.response or self.clock_offset or self.input != "command"):
            raise ValueError("delays alone are of commands, without lags, gains or a clock offset")
        if self.lags and (self.dynamics or self.response or self.input != "wheel"):
            raise ValueError("lags alone are of wheel speeds, without delays and gains")
        return self

    @model_validator(mode="after")
    def _limits_have_commands(self) -> ModelFile:
        limited = any(row.stage == "limits" for row in self.parameters)
        if limited and not self.dynamics:
            raise ValueError("limits are of commands, and this model has no lag and delay of commands")
        if limited and self.wheelbase is not None:
            raise ValueError("limits are of yaw rates, and lags of a robot that steers act on its steering")
        if limited != (self.limit_gains is not None):
            raise ValueError("limit_gains belong to limits of the drive, and these to them")
        return self
