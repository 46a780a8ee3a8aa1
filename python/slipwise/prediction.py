# SPDX-License-Identifier: Apache-2.0
"""Predicting where the robot will go, and how sure that is, from a model and the inputs it will be given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.frames import data_frame
from slipwise.ground import ElevationMap, Ground, Pose
from slipwise.logs.log import Inputs
from slipwise.models.axes import Axes, axes_of, drive_axes
from slipwise.models.model import Model
from slipwise.models.schema import StudentT
from slipwise.models.seen_speeds import warn_of_unseen_speeds
from slipwise.number_text import number_text
from slipwise.path_figure import path_figure
from slipwise.student import LEAST_DOF, MOST_DOF
from slipwise.terrain_ahead import TerrainAhead, slip_ahead

if TYPE_CHECKING:
    import pandas as pd
    import plotly.graph_objects as go

Floats = NDArray[np.float64]

PERIOD = 0.1  # s, between the poses of a predicted path
LONGEST_OFFSET = 10.0  # s; no clock offset is longer
LONGEST_HORIZON = 3600.0  # s
LARGEST_SPEED = 1e3  # m/s and rad/s; what is faster has another unit


@dataclass(frozen=True, eq=False)
class Path:
    """Poses in the robot's frame at the start, [N] each."""

    t: Floats  # s, in the time of the inputs
    poses: Floats  # [N, 3] x, y [m], yaw [rad], the yaw not wrapped
    covariance: (
        Floats  # [N, 3, 3] parameters, the slip disturbance, slip noise, and two measured poses' noise
    )
    dof: Floats  # [N] degrees of freedom of the Student t with this covariance; few are heavy tails
    standing: Floats | None = None  # [N, 3] z [m] above the start, roll, pitch [rad]; None on level ground

    @property
    def poses_in_space(self) -> Floats:
        """The poses as x, y, z [m], roll, pitch, yaw [rad], [N, 6]; the z axis of their frame is vertical."""
        standing = np.zeros((len(self.t), 3)) if self.standing is None else self.standing
        return np.column_stack((self.poses[:, :2], standing, self.poses[:, 2]))

    def __len__(self) -> int:
        return len(self.t)

    @property
    def x(self) -> Floats:
        """Metres ahead of the start, [N]."""
        return self.poses[:, 0]

    @property
    def y(self) -> Floats:
        """Metres to the left of the start, [N]."""
        return self.poses[:, 1]

    @property
    def yaw(self) -> Floats:
        """Headings [rad], not wrapped, [N]."""
        return self.poses[:, 2]

    @property
    def end(self) -> Floats:
        """The last pose: x, y [m], yaw [rad]."""
        last: Floats = self.poses[-1]
        return last

    def __repr__(self) -> str:
        x, y, yaw = (number_text(value) for value in self.poses[-1].tolist())
        seconds = number_text(float(self.t[-1] - self.t[0]))
        return f"<Path of {len(self.t)} poses over {seconds} s to x {x} m, y {y} m, yaw {yaw} rad>"

    def to_dataframe(self) -> pd.DataFrame:
        """Return t, x, y, yaw, the covariance and dof as a pandas data frame, a pose a row.

        Raises:
            SlipwiseError: pandas is not installed.
        """
        columns = {"t": self.t, **dict(zip(("x", "y", "yaw"), self.poses.T, strict=True))}
        upper = (("xx", 0, 0), ("xy", 0, 1), ("xt", 0, 2), ("yy", 1, 1), ("yt", 1, 2), ("tt", 2, 2))
        columns |= {f"cov_{label}": self.covariance[:, i, j] for label, i, j in upper}
        if self.standing is not None:
            columns |= dict(zip(("z", "roll", "pitch"), self.standing.T, strict=True))
        return data_frame(columns | {"dof": self.dof})

    def plot(self) -> go.Figure:
        """Return a Plotly figure of the path from above, with 95 % ellipses; a notebook shows it."""
        return path_figure(self.poses, self.covariance, self.dof)


def predict(  # noqa: PLR0913  (all but the first two are options)
    model: Model,
    commands: Inputs | ArrayLike,
    *,
    horizon: float,
    start: float | None = None,
    initial: tuple[float, ...] | None = None,
    slip_now: _core.SlipNow | None = None,
    ground: Ground | None = None,
    at: Pose = (0.0, 0.0, 0.0),
    terrain_ahead: TerrainAhead | None = None,
    force_age: float = 0.0,
    known_force: tuple[float, float] = (0.0, 0.0),
    input: str | None = None,
) -> Path:
    """Predict the path of base_link under `commands`, wherever on it the pose sensor sits.

    Args:
        model: a learned model.
        commands: held inputs of the kind that the model was learned from: `Inputs`, or rows of
            (t [s], v [m/s], omega [rad/s]), [N, 3]; of a robot that drives sideways (t, v, vy, omega),
            [N, 4], of a car (t, throttle, steering). A steering angle is given as the yaw rate it asks for,
            v tan(angle) / wheelbase. Those before `start` matter where there is lag or delay.
        horizon: how far to predict [s]; poses are returned every `PERIOD` and at the horizon.
        start: when the prediction starts [s], by the clock of the inputs; by default at the first command.
            The robot is at the start of the path then. A pose that was stamped at that moment may be older:
            its sensor's learned `clock_offset` says how much, and has no part in the path. Odometry of a
            learner is the pose at its stamp.
        initial: the drive's measured (v [m/s], omega [rad/s]), or (v, vy, omega), at the start, of which a
            car commanded by throttle and steering takes the speed; by default it follows from the commands,
            before the first of which the robot is at rest.
        slip_now: where the slip disturbance is at the start, as `slip_seen` says; by default nothing recent
            is known of it.
        ground: what the robot drives on, a `Grade` or an `ElevationMap`; level by default. The path is then
            also one in space, and gravity acts where the model has terms of it.
        at: the robot's pose at the start in the frame of the ground, or of the poses that a force was
            learned in (x, y [m], yaw [rad]).
        terrain_ahead: surfaces along the path, of those that the model remembers. Each step slips as on the
            surface that it is driven on; where that is uncertain, as the mixture, whose covariance says so.
        force_age: how long before the start the model was learned [s], where a force was learned beside
            slip: it fades. A day later use `without_force`.
        known_force: what pushes the robot all along, over its mass, ahead and to its left [m/s^2]; it acts
            where the model has terms of gravity, on level ground.
        input: what `commands` are, "command" or "wheel" speeds, where the model answers from both; by
            default commands.

    Raises:
        ModelError: the model does not remember a surface ahead.
        SettingsError: the horizon is not positive or longer than an hour, the start lies before the first
            command, commands or initial speeds are not such rows, not finite or beyond all speeds, the path
            leaves the map of elevations, or a force is not finite, of the future or on a slope.
    """
    _check_force(force_age, known_force, ground)
    model = model.of_input(input).body
    inputs = commands if isinstance(commands, Inputs) else _inputs(commands, axes_of(model))
    if not (np.isfinite(horizon) and horizon > 0.0):
        raise SettingsError("the horizon must be positive seconds", advice="such as horizon=5.0")
    if horizon > LONGEST_HORIZON:
        raise SettingsError(
            f"a horizon of {horizon:g} s is too long", advice=f"give {LONGEST_HORIZON:g} s at most"
        )
    _check_speeds("commands", inputs.v, inputs.vy, inputs.omega)
    warn_of_unseen_speeds(model, np.column_stack((inputs.v, inputs.vy, inputs.omega)), stacklevel=3)
    begin = float(inputs.t[0]) if start is None else float(start)
    if not (np.isfinite(begin) and begin >= inputs.t[0]):
        raise SettingsError("the start must not lie before the first command", advice="give earlier commands")
    measured = None if initial is None else _initial(initial, drive_axes(model))
    given = asked_twists(model, inputs, begin, measured)
    known = None if model.car is not None else _measured_actuator(begin, measured)
    history = model.driven(given) if known is None else model.driven_from(given, begin, known[-1])
    disturbance = _core.DisturbanceFilter(model.disturbance)
    known_now = model.posterior
    now = disturbance.now(known_now, history, []) if slip_now is None else slip_now
    slip = slip_ahead(terrain_ahead, model)
    under = None if ground is None else ground.under(_finite_pose(at))
    ahead = np.append(np.arange(PERIOD, horizon - 1e-9, PERIOD), horizon)
    poses, covariance = [np.zeros(3)], [np.zeros((3, 3))]

    def segment_over(seconds: float) -> _core.Segment:
        end = begin + seconds
        level = _core.Segment(begin, end, _core.Pose2(0.0, 0.0, 0.0), None, *known_force)
        return level.with_ground(under).with_heading(at[2])

    inflation, dof = students_at(model, np.append(0.0, ahead))
    of_inputs = _of_inputs(model, (inputs, begin, measured), history, segment_over(horizon), begin + ahead)
    for seconds, growth, of_curves in zip(ahead.tolist(), inflation[1:].tolist(), of_inputs, strict=True):
        segment = segment_over(seconds)
        if known is not None:
            segment = segment.with_measured_actuator(*known)
        if slip is None:
            posterior = model.posterior_after(force_age + 0.5 * seconds)
            expected = disturbance.predict(posterior, history, now, segment)
        else:
            expected = _core.predict_ahead(disturbance, known_now, history, now, segment, slip.in_core)
        poses.append(expected.pose)
        covariance.append(expected.covariance * growth + of_curves)
    if isinstance(ground, ElevationMap):
        ground.check(_in_frame(np.array(poses), at))
    standing = None if under is None else under.standings(np.array(poses))
    return Path(begin + np.concatenate(([0.0], ahead)), np.array(poses), np.array(covariance), dof, standing)


def slip_seen(model: Model, inputs: Inputs, windows: Sequence[_core.Segment]) -> _core.SlipNow:
    """Return what the last measured windows say of the slip now, for a prediction that starts after them.

    Args:
        model: a learned model.
        inputs: held inputs of the kind that the model was learned from, since before the first window.
        windows: between two measured poses, in order of time, as long as those that the model was learned
            from (`slip_disturbance.segment` of the model file). Those of the last 30 s say all there is.
    """
    history = model.driven(asked_twists(model, inputs))
    return _core.DisturbanceFilter(model.disturbance).now(model.posterior, history, list(windows))


def asked_twists(
    model: Model, inputs: Inputs, begin: float | None = None, initial: Floats | None = None
) -> _core.InputHistory:
    """Inputs as twists; those of a car commanded by throttle and steering go through its curves."""
    if model.car is None:
        return _core.InputHistory(inputs.t, inputs.v, inputs.vy, inputs.omega)
    measured = None if begin is None or initial is None else (begin, float(initial[0]))
    return model.car.twists(_car_commands(inputs), float(inputs.t[0]), measured)


def _car_commands(inputs: Inputs) -> _core.InputHistory:
    """Throttle and steering, as the core takes them in place of speed and yaw rate."""
    known = inputs.car
    throttle, steering = (inputs.v, inputs.omega) if known is None else (known.throttle, known.steering)
    return _core.InputHistory(inputs.t, throttle, np.zeros_like(throttle), steering)


def _of_inputs(
    model: Model,
    asked: tuple[Inputs, float, Floats | None],
    history: _core.InputHistory,
    segment: _core.Segment,
    times: Floats,
) -> Sequence[Floats]:
    """Covariances [3, 3] of the poses at `times` [s], of what a car never showed of its curves."""
    if model.car is None:
        return [np.zeros((3, 3)) for _ in times]
    inputs, begin, initial = asked
    measured = None if initial is None else (begin, float(initial[0]))
    spread = model.car.spread(_car_commands(inputs), float(inputs.t[0]), measured)
    return _core.input_covariances(model.motion, model.mean, history, spread, segment, times.tolist())


def _measured_actuator(
    begin: float, initial: Floats | None
) -> tuple[_core.InputHistory, float, _core.BodyTwist] | None:
    """Speeds measured at `begin`, held while the poses, stamped late, were under way."""
    if initial is None:
        return None
    held = _core.InputHistory(*(np.array([value]) for value in (begin - LONGEST_OFFSET, *initial)))
    return held, begin, _core.BodyTwist(*initial.tolist())


def student_at(model: Model, horizon: float) -> StudentT:
    """Growth of the covariance and degrees of freedom at a horizon [s], as `students_at` says."""
    inflation, dof = students_at(model, np.array([horizon]))
    return StudentT(inflation=float(inflation[0]), dof=float(dof[0]))


def students_at(model: Model, horizons: Floats) -> tuple[Floats, Floats]:
    """Growth of the covariance [N] and degrees of freedom [N] at horizons [N] in s.

    Their logarithms are interpolated between the horizons judged, and kept beyond them; without any, the
    covariance is taken as stated and nearly normal.
    """
    students = model.content.noise.student_t
    if not students:
        return np.ones(len(horizons)), np.full(len(horizons), MOST_DOF)
    seconds = sorted(students)
    inflation, dof = (
        np.exp(np.interp(horizons, seconds, [np.log(getattr(students[s], name)) for s in seconds]))
        for name in ("inflation", "dof")
    )
    return inflation, np.clip(dof, LEAST_DOF, MOST_DOF)


def _initial(initial: tuple[float, ...], axes: Axes) -> Floats:
    """Return initial speeds as (v, vy, omega)."""
    values = np.atleast_1d(np.asarray(initial, dtype=np.float64))
    axes.check("the initial speeds are given", values.shape[-1])
    if values.ndim != 1 or not np.isfinite(values).all():
        raise SettingsError("the initial speeds must be finite", advice="such as initial=(0.5, 0.0)")
    _check_speeds("initial speeds", values)
    return axes.twists(values)


def _check_force(age: float, known: tuple[float, float], ground: Ground | None) -> None:
    if not (np.isfinite(age) and age >= 0.0):
        raise SettingsError("the force must be of now or before", advice="give force_age in s, 0 or more")
    if np.shape(known) != (2,) or not np.isfinite(known).all():
        raise SettingsError("the known force must be two finite numbers", advice="known_force=(0.0, 1.5)")
    if ground is not None and any(known):
        raise SettingsError(
            "a known force acts on level ground alone", advice="leave out the ground or known_force"
        )


def _finite_pose(pose: Pose) -> Pose:
    if np.shape(pose) != (3,) or not np.isfinite(pose).all():
        raise SettingsError("the pose on the ground must be finite", advice="such as at=(0.0, 0.0, 0.5)")
    return pose


def _in_frame(poses: Floats, at: Pose) -> Floats:
    """Poses [N, 3] seen from `at`, in the frame of `at`."""
    turn = np.exp(1j * at[2]) * (poses[:, 0] + 1j * poses[:, 1])
    return np.column_stack((at[0] + turn.real, at[1] + turn.imag, at[2] + poses[:, 2]))


def _check_speeds(name: str, *speeds: Floats) -> None:
    fastest = max(float(np.abs(column).max(initial=0.0)) for column in speeds)
    if fastest > LARGEST_SPEED:
        raise SettingsError(
            f"the {name} reach {fastest:g}, where {LARGEST_SPEED:g} is the most",
            advice="give v in m/s and omega in rad/s",
        )


def _inputs(commands: ArrayLike, axes: Axes) -> Inputs:
    try:
        rows = np.asarray(commands, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise _not_rows("are no numbers", axes) from problem
    if rows.ndim != 2 or rows.shape[1] != 1 + len(axes) or len(rows) == 0:
        raise _not_rows(f"have shape {rows.shape}", axes)
    if not np.isfinite(rows).all():
        raise _not_rows("are not finite", axes)
    if not (np.diff(rows[:, 0]) > 0.0).all():
        raise _not_rows("do not go forward in time", axes)
    v, vy, omega = (np.ascontiguousarray(column) for column in axes.twists(rows[:, 1:]).T)
    return Inputs(t=np.ascontiguousarray(rows[:, 0]), v=v, vy=vy, omega=omega)


def _not_rows(fault: str, axes: Axes) -> SettingsError:
    names = ", ".join(("t", *axes.names))
    return SettingsError(
        f"commands {fault} where rows of ({names}) are needed, finite and in order of t",
        advice=f"stack them with numpy.column_stack(({names}))",
    )
