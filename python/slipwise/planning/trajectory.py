# SPDX-License-Identifier: Apache-2.0
"""Trajectories to a goal pose through the learned model, within limits (thesis 8.4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.argument_types import check_arguments
from slipwise.errors import PlanningError, SettingsError
from slipwise.ground import ElevationMap, Ground, Pose
from slipwise.models.axes import SIDEWAYS, TWIST, Axes, axes_of
from slipwise.models.model import Model
from slipwise.models.seen_speeds import warn_of_unseen_speeds
from slipwise.number_text import number_text
from slipwise.planning.limits import AT_REST, DriveState, Limits, limits_of
from slipwise.prediction import PERIOD, Path, predict

Floats = NDArray[np.float64]

CRUISE_FRACTION = 0.7  # of the limit of speed, where the user says nothing
LONG_AGO = 1e4  # s before a plan, when what was commanded last is taken to have been commanded


@dataclass(frozen=True)
class TrajectoryOptions:
    """How trajectories are shaped."""

    cruise: float | None = None  # m/s between the ramps; by default `CRUISE_FRACTION` of the limit
    end_speed: float = 0.0  # m/s commanded at the goal; 0 waits until the robot has come to rest
    rest_speed: float = 0.02  # m/s; no faster counts as rest
    rest_yaw_rate: float = 0.02  # rad/s; no faster counts as rest
    longest: float = 10.0  # m, of commanded paths
    backwards: bool = False  # drive backwards all the way
    commands: int = 32  # each held for the same time
    guesses: int = 12  # first manoeuvres that are tried at most
    tolerance_xy: float = 1e-3  # m
    tolerance_yaw: float = 1e-3  # rad

    def to_core(self, limits: Limits) -> _core.TrajectorySettings:
        """Return the options as the core takes them."""
        settings = _core.TrajectorySettings()
        settings.cruise = CRUISE_FRACTION * limits.speed if self.cruise is None else self.cruise
        settings.end_speed = self.end_speed
        settings.rest_speed, settings.rest_yaw_rate = self.rest_speed, self.rest_yaw_rate
        settings.longest = self.longest
        settings.backwards = self.backwards
        settings.commands = self.commands
        settings.guesses = self.guesses
        settings.tolerance_xy = self.tolerance_xy
        settings.tolerance_yaw = self.tolerance_yaw
        return settings


NOMINAL = TrajectoryOptions()


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Commands, each held until the next and the last one on, and the path that they cause."""

    commands: Floats  # [N, 1 + axes] t [s] from 0 on, v [m/s], omega [rad/s]; none goes sideways
    t: Floats  # [M] s, of the poses
    poses: Floats  # [M, 3] x, y [m], yaw [rad] in the frame of the goal, the yaw not wrapped
    at_end: DriveState  # when the goal is reached

    def __repr__(self) -> str:
        x, y, yaw = (number_text(value) for value in self.poses[-1].tolist())
        commands, seconds = len(self.commands), number_text(self.duration)
        return f"<Trajectory of {commands} commands over {seconds} s to x {x} m, y {y} m, yaw {yaw} rad>"

    @property
    def duration(self) -> float:
        """Time from the first command until the goal is reached [s]."""
        return float(self.t[-1])

    @property
    def columns(self) -> dict[str, Floats]:
        """Commands over their times by the names of their axes, each [N]."""
        axes = SIDEWAYS if self.commands.shape[1] > 1 + len(TWIST) else TWIST
        return dict(zip(axes.names, self.commands[:, 1:].T, strict=True))


class Planner:
    """Plans to any goal from states near one start; it keeps a table of manoeuvres made for that start.

    Commands keep within `limits`. What the drive's learned limits make of them is part of the path: goals are
    reached through dead-band, top speed and ramps.

    Args:
        model: a learned model.
        limits: of the commands; by default what the model was learned within.
        options: how trajectories are shaped.
        state: what the robot usually does when a plan begins.
        ground: what the robot drives on, in the frame of the goals; level by default. Poses are as seen from
            above.

    Raises:
        ModelError: the model takes throttle and steering.
        SettingsError: limits, options or state contradict each other.
    """

    def __init__(
        self,
        model: Model,
        *,
        limits: Limits | None = None,
        options: TrajectoryOptions = NOMINAL,
        state: DriveState = AT_REST,
        ground: Ground | None = None,
    ) -> None:
        check_arguments(Planner.__init__, locals())
        model.refuse_throttle("planned trajectories")
        self._model = model
        self._axes, self._options = axes_of(model), options
        self.limits = limits_of(model) if limits is None else limits
        self.ground = ground
        settings = options.to_core(self.limits)
        model.refuse_heading("trajectories")
        try:
            self._core = _core.TrajectoryPlanner(
                model.motion, model.mean, self.limits.to_core(), settings, state.to_core(), model.limits
            )
        except ValueError as problem:
            raise SettingsError(str(problem), where="trajectory options") from problem

    def try_to(
        self, goal: Pose, *, start: Pose = (0.0, 0.0, 0.0), state: DriveState = AT_REST
    ) -> Trajectory | None:
        """Return a trajectory from `start` to `goal`, None where there is none; see `to`.

        It is for searches, and does not warn of speeds that the model has not seen.
        """
        if self._stays(goal, start, state):
            return _staying(start, state, self._axes)
        plan = self._plan(goal, start, state)
        if plan.status != _core.TrajectoryStatus.Reached:
            return None
        found = _trajectory(plan, start, self._axes)
        return found if self._holds(found.poses) else None

    def to(self, goal: Pose, *, start: Pose = (0.0, 0.0, 0.0), state: DriveState = AT_REST) -> Trajectory:
        """Return a trajectory from `start` to `goal`, both (x [m], y [m], yaw [rad]) in one frame.

        It warns where it drives as the model has never seen the robot drive, such as to a side. A robot that
        rests at the goal already stays: a trajectory of one command and no length.

        Raises:
            PlanningError: no manoeuvre within the limits ends at the goal.
            SettingsError: a pose is not finite, the start is faster than the limits, or the path leaves the
                map of elevations.
        """
        if self._stays(goal, start, state):
            return _staying(start, state, self._axes)
        plan = self._plan(goal, start, state)
        if plan.status != _core.TrajectoryStatus.Reached:
            what, _, advice = _core.trajectory_advice(plan.status).partition(": ")
            nearest = f"the nearest attempt ends {plan.gap_xy:.2g} m and {plan.gap_yaw:.2g} rad beside it"
            raise PlanningError(f"{what}; {nearest}", where=f"goal {pose_text(goal)}", advice=advice)
        found = _trajectory(plan, start, self._axes)
        if isinstance(self.ground, ElevationMap):
            self.ground.check(found.poses)
        warn_of_unseen_speeds(self._model, found.commands[:, 1:], stacklevel=2)
        return found

    def _stays(self, goal: Pose, start: Pose, state: DriveState) -> bool:
        """Whether the robot rests at the goal already, within the tolerances, and is to end at rest."""
        left, options = _core.between(to_core_pose(start, "start"), to_core_pose(goal, "goal")), self._options
        near = np.hypot(left.x, left.y) <= options.tolerance_xy
        turned = abs(_core.wrap_angle(left.theta)) <= options.tolerance_yaw
        v, omega = np.abs((state.drive, state.commanded)).max(axis=0)
        rests = v <= options.rest_speed and omega <= options.rest_yaw_rate
        return bool(near and turned and rests and options.end_speed == 0.0)

    def _plan(self, goal: Pose, start: Pose, state: DriveState) -> _core.Trajectory:
        relative = _core.between(to_core_pose(start, "start"), to_core_pose(goal, "goal"))
        under = None if self.ground is None else self.ground.under(start)
        try:
            return self._core.to(relative, state.to_core(), under)
        except ValueError as problem:
            raise SettingsError(str(problem), where="start state") from problem

    def _holds(self, poses: Floats) -> bool:
        """Whether the ground is known under all poses."""
        return not isinstance(self.ground, ElevationMap) or self.ground.holds(poses)


def trajectory_to(  # noqa: PLR0913 - what a Planner takes, and what its `to` takes
    model: Model,
    goal: Pose,
    *,
    start: Pose = (0.0, 0.0, 0.0),
    limits: Limits | None = None,
    options: TrajectoryOptions = NOMINAL,
    state: DriveState = AT_REST,
    ground: Ground | None = None,
) -> Trajectory:
    """Plan once; whoever plans often keeps a `Planner`, whose table is made once. See `Planner.to`."""
    planner = Planner(model, limits=limits, options=options, state=state, ground=ground)
    return planner.to(goal, start=start, state=state)


def uncertain_path(
    model: Model,
    trajectory: Trajectory,
    *,
    state: DriveState = AT_REST,
    ground: Ground | None = None,
    at: Pose = (0.0, 0.0, 0.0),
) -> Path:
    """Return the path of a trajectory with its covariance, from the origin; see `predict`, also for `at`.

    That of a robot that stays is predicted for a moment.
    """
    axes = axes_of(model)
    before = np.array([[-LONG_AGO, *axes.ahead(state.commanded)]])
    commands = np.vstack((before, trajectory.commands))
    drive = tuple(axes.ahead(state.drive).tolist())
    horizon = trajectory.duration or PERIOD
    return predict(model, commands, horizon=horizon, start=0.0, initial=drive, ground=ground, at=at)


def to_core_pose(pose: Pose, name: str) -> _core.Pose2:
    """Return a pose as the core takes it.

    Raises:
        SettingsError: it is not three finite numbers.
    """
    try:
        values = np.asarray(pose, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.zeros(0)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise SettingsError(
            f"the {name} is not a pose", where=str(pose), advice="give finite x, y [m], yaw [rad]"
        )
    return _core.Pose2(*map(float, values))


def pose_text(pose: Pose) -> str:
    """Return a pose to the millimetre and milliradian."""
    return ", ".join(f"{round(value, 3) + 0.0:.10g}" for value in pose)


def placed(poses: Floats, start: Pose) -> Floats:
    """Return poses [N, 3] seen from `start` in the frame that `start` is given in."""
    cos, sin = np.cos(start[2]), np.sin(start[2])
    x = start[0] + cos * poses[:, 0] - sin * poses[:, 1]
    y = start[1] + sin * poses[:, 0] + cos * poses[:, 1]
    return np.column_stack((x, y, start[2] + poses[:, 2]))


def _staying(start: Pose, state: DriveState, axes: Axes) -> Trajectory:
    """Return the trajectory of a robot that stays where it is."""
    still = np.hstack((0.0, axes.ahead((0.0, 0.0))))
    at_end = replace(state, commanded=(0.0, 0.0))
    return Trajectory(still[None], np.zeros(1), np.array([start], dtype=np.float64), at_end)


def _trajectory(plan: _core.Trajectory, start: Pose, axes: Axes) -> Trajectory:
    drive = plan.drive
    return Trajectory(
        commands=np.column_stack((plan.t, axes.ahead(np.column_stack((plan.v, plan.omega))))),
        t=np.asarray(plan.path_t),
        poses=placed(np.asarray(plan.path), start),
        at_end=DriveState(
            drive=(drive.v, drive.omega),
            commanded=(float(plan.v[-1]), float(plan.omega[-1])),
            fast=(plan.fast.v, plan.fast.omega),
        ),
    )
