# SPDX-License-Identifier: Apache-2.0
"""The MPPI controller: sampled commands driven through a learned model, averaged by cost, in C++."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError
from slipwise.ground import Grade, Pose, rise_of
from slipwise.models.axes import SIDEWAYS, THROTTLE, TWIST, Axes, drive_axes
from slipwise.models.model import Model
from slipwise.models.seen_speeds import warn_of_unseen_speeds
from slipwise.planning.costmap import Costmap
from slipwise.planning.grid_map import GridMap
from slipwise.planning.reference_path import ReferencePath
from slipwise.planning.trajectory import to_core_pose
from slipwise.terrain_ahead import TerrainAhead, slip_ahead

Floats = NDArray[np.float64]

LETHAL = 100.0  # cost of a cell where the robot's disc touches something
MOST_PAST = 200  # commands that are remembered


@dataclass(frozen=True)
class Motion:
    """A motion model with its parameters, as a controller drives through it."""

    model: _core.MotionModel
    parameters: Floats
    limits: _core.CommandLimits | None = None  # of the drive, in front of its delay and lag
    grade: Grade | None = None  # of the ground in the frame of the reference; level where there is none
    slip_ahead: _core.MixedAhead | None = None  # on surfaces from the robot's place on, where it changes
    car: _core.CarCurves | None = None  # in front of all, where commands are throttle and steering
    sideways: bool = False  # commands have a speed to the left, too

    def __repr__(self) -> str:
        return f"<Motion: {self.model.basis.name}, {len(self.parameters)} parameters>"


def baseline_motion() -> Motion:
    """Return the motion of a robot that does at once and exactly what it is commanded."""
    return Motion(_core.MotionModel(_core.Basis("none", [], [], []), False, False), np.zeros(0))


def vendor_motion(multiplier: float) -> Motion:
    """Return the motion of a robot that turns `multiplier` times less than it is commanded."""
    model = _core.MotionModel(_core.named_basis("edd-2"), False, False)
    return Motion(model, np.array([0.0, 1.0 / multiplier - 1.0]))


def learned_motions(  # noqa: PLR0913  (all but the first are options)
    model: Model,
    *,
    samples: int = 0,
    seed: int = 1,
    seconds: float = 2.8,
    grade: Grade | None = None,
    terrain_ahead: TerrainAhead | None = None,
) -> list[Motion]:
    """Return the mean motion of a model, and `samples` more with parameters drawn from its covariance.

    The slip disturbance is drawn as its mean over `seconds`, by default the controller's horizon. All have
    the limits of the drive that were learned, and drive on the `grade`. With `terrain_ahead`, slip is that
    of the surfaces from the robot's place on; `Controller.adopt` takes what is ahead as the robot goes.

    Raises:
        ModelError: the model does not remember a surface ahead.
        SettingsError: samples of slip on surfaces ahead are asked for.
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    model = model.body
    model.refuse_heading("controllers")
    slip, sideways = slip_ahead(terrain_ahead, model), drive_axes(model).sideways
    if slip is not None:
        if samples:
            raise SettingsError(
                "no samples are drawn of slip on surfaces ahead",
                where="samples",
                advice="leave them out, or draw futures by `sample_futures`",
            )
        ahead = slip.in_core
        mean = slip.parameters(model)
        return [Motion(model.motion, mean, model.limits, grade, ahead, model.car, sideways)]
    drawn = np.zeros((samples, 0))  # of a model without terms
    if len(model.mean):
        spread = model.covariance_over(seconds)
        drawn = rng.multivariate_normal(model.mean, spread, size=samples, method="eigh")
    return [
        Motion(model.motion, parameters, model.limits, grade, car=model.car, sideways=sideways)
        for parameters in (model.mean, *drawn)
    ]


@dataclass(frozen=True)
class MppiOptions:
    """Settings of the controller; the defaults suit a robot of a metre at a metre per second.

    Of a car commanded by throttle and steering, speeds are throttles and yaw rates steerings; see `for_car`.
    """

    rollouts: int = 2048
    periods: int = 56
    period: float = 0.05  # s
    highest_speed: float = 1.5  # m/s
    lowest_speed: float = 0.0  # m/s
    yaw_rate: float = 1.0  # rad/s
    acceleration: float = 1.0  # m/s^2
    yaw_acceleration: float = 2.0  # rad/s^2
    sideways_speed: float = 0.5  # m/s to both sides, of a robot that drives sideways
    sideways_acceleration: float = 1.0  # m/s^2
    speed_std: float = 0.3  # m/s of the samples
    yaw_rate_std: float = 0.4  # rad/s of the samples
    sideways_std: float = 0.2  # m/s of the samples
    colour: float = 0.3  # s over which the noise changes
    temperature: float = 0.3  # of the excess cost of the best quarter, where a rollout weighs e^-1
    risk: float = 0.0  # 0 counts the mean cost over the motions, 1 the worst
    across: float = 20.0  # cost per squared metre beside the reference and second
    along: float = 2.0  # per squared metre ahead or behind and second
    heading: float = 1.0  # per squared radian and second
    smoothness: float = 0.05  # per squared fraction of the largest change of a command
    obstacle: float = 1.0  # per cost of the map and second
    seed: int = 1

    def for_car(self) -> MppiOptions:
        """Return the options with limits and noise for throttle and steering, which have no units."""
        return replace(
            self,
            highest_speed=1.0,
            lowest_speed=0.0,
            yaw_rate=1.0,
            acceleration=2.0,
            yaw_acceleration=4.0,
            speed_std=0.15,
            yaw_rate_std=0.4,
        )

    def to_core(self) -> _core.MppiSettings:
        """Return the options as the core takes them."""
        limits, costs, settings = _core.MppiLimits(), _core.MppiCosts(), _core.MppiSettings()
        for name in ("highest_speed", "lowest_speed", "yaw_rate", "acceleration", "yaw_acceleration"):
            setattr(limits, name, getattr(self, name))
        for name in ("sideways_speed", "sideways_acceleration"):
            setattr(limits, name, getattr(self, name))
        for name in ("across", "along", "heading", "smoothness", "obstacle"):
            setattr(costs, name, getattr(self, name))
        costs.lethal = LETHAL
        for name in ("rollouts", "periods", "period", "speed_std", "yaw_rate_std", "colour"):
            setattr(settings, name, getattr(self, name))
        settings.sideways_std = self.sideways_std
        settings.temperature, settings.risk, settings.seed = self.temperature, self.risk, self.seed
        settings.limits, settings.costs = limits, costs
        return settings


NOMINAL = MppiOptions()


def inflated(grid: GridMap, radius: float, *, inflation: float = 0.5) -> Costmap:
    """Return the cost of every place for a robot's disc: lethal in obstacles, falling to 0 beside them.

    Args:
        grid: what is free.
        radius: of a disc that covers the robot [m].
        inflation: how far from touching something places still cost [m].

    Raises:
        SettingsError: radius or inflation are not positive.
    """
    if not (np.isfinite([radius, inflation]).all() and radius > 0.0 and inflation > 0.0):
        raise SettingsError("radius and inflation must be positive", where="inflation", advice="give metres")
    near = np.clip(1.0 - (grid.clearance - radius) / inflation, 0.0, 1.0)
    cells = np.where(grid.clearance < radius, LETHAL, 0.5 * LETHAL * near**2).astype(np.float32)
    return Costmap(cells, grid.resolution, grid.origin, LETHAL)


_InCore = tuple[
    _core.MotionModel, Floats, _core.CommandLimits | None, tuple[float, float], _core.MixedAhead | None, bool
]


def _as_core(motions: list[Motion]) -> list[_InCore]:
    return [
        (
            m.model,
            m.parameters,
            m.limits,
            rise_of(m.grade),
            m.slip_ahead,
            m.sideways or m.model.basis.sideways,
        )
        for m in motions
    ]


def _car_of(motions: list[Motion], options: MppiOptions) -> _core.CarCurves | None:
    """Return the curves of a car in front of all motions, None where they take speeds."""
    car = motions[0].car if motions else None
    if any((motion.car is None) != (car is None) for motion in motions):
        raise SettingsError("models of throttle and of speeds do not mix", where="controller's motions")
    if car is not None and max(options.highest_speed, -options.lowest_speed, options.yaw_rate) > 1.0:
        raise SettingsError(
            "throttle and steering are at most 1", where="controller options", advice="use options.for_car()"
        )
    return car


def _axes_of(motions: list[Motion]) -> tuple[Axes, Axes]:
    """Return the axes of the drive and of the commands."""
    if motions and motions[0].car is not None:
        return TWIST, THROTTLE
    sideways = bool(motions) and (motions[0].sideways or motions[0].model.basis.sideways)
    return (SIDEWAYS, SIDEWAYS) if sideways else (TWIST, TWIST)


def _twist(what: str, given: tuple[float, ...], axes: Axes) -> Floats:
    """Return finite numbers of these axes as the core's (v, vy, omega).

    Raises:
        SettingsError: they are not.
    """
    values = np.asarray(given, dtype=np.float64)
    if values.shape != (len(axes),) or not np.isfinite(values).all():
        raise SettingsError(f"{what} is not a finite {axes.words}", advice=f"give {len(axes)} numbers")
    return axes.twists(values)


class Controller:
    """Follows a reference, one command per period.

    Args:
        motions: through which sampled commands are driven: a learned model, or motions made of one, several
            where risk counts (`learned_motions`).
        reference: what to follow.
        options: settings.
        obstacles: costs of places, `LETHAL` where a collision is; see `inflated`.

    Raises:
        SettingsError: there is no motion, or an option makes no sense.
    """

    def __init__(
        self,
        motions: Model | list[Motion],
        reference: ReferencePath,
        *,
        options: MppiOptions = NOMINAL,
        obstacles: Costmap | None = None,
    ) -> None:
        if not isinstance(reference, ReferencePath):
            raise SettingsError(
                f"a controller follows a ReferencePath, not {type(reference).__name__}",
                where="controller's reference",
                advice="such as ReferencePath(points, speed=1.0)",
            )
        self._unwarned = motions if isinstance(motions, Model) else None
        motions = learned_motions(motions) if isinstance(motions, Model) else motions
        self.reference, self.options = reference, options
        self._obstacles = obstacles  # keeps the cells
        try:
            self._core = _core.Mppi(_as_core(motions), options.to_core(), _car_of(motions, options))
        except (ValueError, TypeError, OverflowError) as problem:
            raise SettingsError(str(problem).splitlines()[0], where="controller options") from problem
        self._drive, self._commands = _axes_of(motions)
        self._past = np.zeros((0, 3))

    def adopt(self, motions: Model | list[Motion]) -> None:
        """Drive through other motions from the next command on; the plan and the commands sent are kept.

        Raises:
            SettingsError: there is no motion, or one has no sense.
        """
        unwarned = motions if isinstance(motions, Model) else None
        motions = learned_motions(motions) if isinstance(motions, Model) else motions
        try:
            self._core.adopt(_as_core(motions), _car_of(motions, self.options))
        except (ValueError, TypeError) as problem:
            raise SettingsError(str(problem).splitlines()[0], where="controller's motions") from problem
        self._unwarned = unwarned

    def command(
        self, pose: Pose, drive: tuple[float, ...], *, last: tuple[float, ...] | None = None
    ) -> tuple[float, ...]:
        """Return the next command; call it once per period.

        It warns once where it commands speeds that the model it was given has not seen.

        It is (v [m/s], omega [rad/s]), (throttle, steering) of a car that takes these, or (v, vy, omega) of a
        robot that drives sideways.

        Args:
            pose: of the robot now, in the frame of the reference.
            drive: what the drive does now (v, omega), or (v, vy, omega), as wheels show it.
            last: the command that was sent last, where it is not what this controller returned. At the first
                call, without it, the drive is taken to have been commanded what it does: a robot that moves
                goes on moving.

        Raises:
            SettingsError: pose, drive or the last command are not finite.
            PlanningError: the robot is inside an obstacle.
        """
        at = to_core_pose(pose, "robot's pose")
        if last is not None:
            self._past = np.vstack((self._past[:-1], _twist("the last command", last, self._commands)))
        moving = _twist("the drive", drive, self._drive)
        obstacles = None if self._obstacles is None else self._obstacles.in_core
        wanted = self.reference.ahead(pose, self.options.periods, self.options.period)
        try:
            result = self._core.step(at, moving, self._past, wanted, obstacles)
        except ValueError as problem:
            kind = PlanningError if "obstacle" in str(problem) else SettingsError
            raise kind(str(problem), where="controller") from problem
        self._past = np.vstack((self._past, result.command))[-MOST_PAST:]
        if self._unwarned is not None and warn_of_unseen_speeds(self._unwarned, result.command, stacklevel=2):
            self._unwarned = None
        return self._commands.of_twist(result.command)
