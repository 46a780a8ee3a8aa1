# SPDX-License-Identifier: Apache-2.0
"""State-lattice primitives that a learned model can drive, in the file format of Nav2's Smac planner."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import PlanningError, SettingsError
from slipwise.files import write_text_whole
from slipwise.ground import Grade
from slipwise.models.axes import refuse_sideways
from slipwise.models.model import Model
from slipwise.models.seen_speeds import warn_of_unseen_speeds
from slipwise.planning.holdable import curvature_map
from slipwise.planning.limits import Limits, limits_of

Floats = NDArray[np.float64]

FORMAT = 1.0  # version of the file format
FULL_TURN = 2.0 * math.pi
TRIES = 400  # end points for one change of heading, nearest first
CLOSER = 1.35  # a primitive is at most so much longer than its chord's arc
STOPPING = (
    5  # stated in the file as by the generator of Nav2, which searches in waves; here nothing follows from it
)


@dataclass(frozen=True)
class LatticeOptions:
    """The lattice; headings are those of Nav2, which let straight primitives end on grid points."""

    speed: float = 0.5  # m/s, the same along all primitives
    grid: float = 0.05  # m between grid points; that of the costmap
    headings: int = 16  # a multiple of 8
    turns: int = 3  # headings by which one primitive turns at most
    longest: float = 6.0  # m


@dataclass(frozen=True, eq=False)
class Primitive:
    """From a heading at the origin to another heading at a grid point."""

    start: int  # place of its heading
    end: int
    poses: Floats  # [N, 3] x, y [m], yaw [rad] about a grid step apart; the start is left out, as Nav2 does
    length: float  # m
    swing: float  # rad, from its heading at the start to that at the end
    commands: Floats  # [K, 2] v [m/s], omega [rad/s], each held for the same time


def heading_angles(count: int) -> Floats:
    """Return the headings [count], rad from 0 on: towards the grid points of a square's edge.

    Raises:
        SettingsError: the count is no multiple of 8.
    """
    if count < 8 or count % 8:
        raise SettingsError(f"{count} headings", where="headings", advice="give a multiple of 8, such as 16")
    side = count // 8
    edge = [(side, k) for k in range(side)] + [(side - k, side) for k in range(side)]
    quarter = np.array([math.atan2(y, x) for x, y in edge])
    return np.concatenate([quarter + k * math.pi / 2.0 for k in range(4)])


def lattice_primitives(
    model: Model,
    *,
    options: LatticeOptions = LatticeOptions(),
    limits: Limits | None = None,
    grade: Grade | None = None,
) -> list[Primitive]:
    """Return primitives by their start heading, each from straight driving to straight driving at one speed.

    They have the model's slip, on a `grade` that of each heading against the slope; poses are as seen from
    above. Lag, delay and limits of the drive are left out: they shift where a command acts, which is up to
    the controller that follows the plan. They warn where they drive as the model has never seen the robot
    drive, such as to a side.

    Raises:
        SettingsError: an option makes no sense.
        PlanningError: a heading has no primitive.
    """
    _check(options)
    angles = heading_angles(options.headings)
    planner = _steady_planner(model, options, limits_of(model) if limits is None else limits)
    found: list[Primitive] = []
    # On level ground the grid looks the same to a robot that is turned by a quarter.
    apart = options.headings // 4 if grade is None else options.headings
    for start, turn in itertools.product(range(apart), range(-options.turns, options.turns + 1)):
        under = None if grade is None else grade.under((0.0, 0.0, float(angles[start])))
        made = _shortest(partial(planner.to, ground=under), angles, (start, turn), options)
        if made is not None:
            found.append(made)
    if {made.start for made in found} != set(range(apart)):
        raise PlanningError(
            "some headings have no primitive",
            where="lattice",
            advice="allow longer primitives, a lower speed or a coarser grid",
        )
    warn_of_unseen_speeds(model, np.vstack([made.commands for made in found]), stacklevel=2)
    quarters = options.headings // apart
    turned = [_quarter_turned(made, k, options.headings) for k in range(quarters) for made in found]
    return sorted(turned, key=lambda made: (made.start, (made.end - made.start) % options.headings))


def write_lattice(
    path: str | Path,
    model: Model,
    *,
    options: LatticeOptions = LatticeOptions(),
    limits: Limits | None = None,
    grade: Grade | None = None,
) -> Path:
    """Write the primitives as the JSON file that Nav2's `lattice_filepath` names; return its path.

    Raises:
        OutputError: the file cannot be written.
        SettingsError, PlanningError: as of `lattice_primitives`.
    """
    within = limits_of(model) if limits is None else limits
    made = lattice_primitives(model, options=options, limits=within, grade=grade)
    target = Path(path)
    held = curvature_map(model, limits=within, speeds=40)
    row = int(np.argmin(np.abs(held.speed - options.speed)))
    tightest = np.nanmin([side[row] for side in held.tightest()])
    metadata = {
        "motion_model": "ackermann",
        "turning_radius": round(float(1.0 / tightest), 5),
        "grid_resolution": options.grid,
        "stopping_threshold": STOPPING,
        "num_of_headings": options.headings,
        "heading_angles": heading_angles(options.headings).tolist(),
        "number_of_trajectories": len(made),
    }
    content = {
        "version": FORMAT,
        "date_generated": f"{datetime.now(UTC):%Y-%m-%d}",
        "lattice_metadata": metadata,
        "primitives": [_entry(number, primitive) for number, primitive in enumerate(made)],
    }
    write_text_whole(target, json.dumps(content, indent=1) + "\n")
    return target


def _check(options: LatticeOptions) -> None:
    for name in ("speed", "grid", "longest"):
        value = getattr(options, name)
        if not (math.isfinite(value) and value > 0.0):
            raise SettingsError(f"{name} is {value}", where=name, advice="give a positive number")
    if not 1 <= options.turns <= options.headings // 4:
        raise SettingsError(
            f"turns by {options.turns} headings",
            where="turns",
            advice="give 1 up to a quarter of the headings",
        )


def _steady_planner(model: Model, options: LatticeOptions, limits: Limits) -> _core.TrajectoryPlanner:
    model.refuse_heading("lattices")
    model.refuse_throttle("lattices")
    refuse_sideways(model, "lattices")
    settings = _core.TrajectorySettings()
    settings.cruise = settings.end_speed = options.speed
    settings.longest, settings.straight_end, settings.guesses = options.longest, True, 3
    motion = _core.MotionModel(model.motion.basis, False, False)
    try:
        return _core.TrajectoryPlanner(
            motion, model.mean[: motion.slip_size], limits.to_core(), settings, _driving(options.speed), None
        )
    except ValueError as problem:
        raise SettingsError(str(problem), where="lattice options") from problem


def _driving(speed: float) -> _core.ActuatorState:
    straight = _core.BodyTwist(speed, 0.0, 0.0)
    return _core.ActuatorState(straight, straight, None)


def _shortest(
    plan_to: Callable[[_core.Pose2, _core.ActuatorState], _core.Trajectory],
    angles: Floats,
    change: tuple[int, int],
    options: LatticeOptions,
) -> Primitive | None:
    """Return the primitive with the nearest end point for a start heading and a turn, or None."""
    start, turn = change
    end = (start + turn) % len(angles)
    heading = float(angles[start])
    swing = _core.wrap_angle(float(angles[end]) - heading)
    for x, y in itertools.islice(_end_points(heading, swing, options), TRIES):
        cos, sin = math.cos(heading), math.sin(heading)
        goal = _core.Pose2(cos * x + sin * y, cos * y - sin * x, swing)
        plan = plan_to(goal, _driving(options.speed))
        if plan.status != _core.TrajectoryStatus.Reached:
            continue
        path = np.asarray(plan.path)
        length = float(np.hypot(*np.diff(path[:, :2], axis=0).T).sum())
        half = 0.5 * abs(swing)
        arc = math.hypot(x, y) * (half / math.sin(half) if half > 0.0 else 1.0)
        if length <= CLOSER * arc:
            turned = np.column_stack(
                (cos * path[:, 0] - sin * path[:, 1], sin * path[:, 0] + cos * path[:, 1])
            )
            placed = np.column_stack((turned, heading + path[:, 2]))
            placed[-1] = x, y, heading + swing
            commands = np.column_stack((plan.v, plan.omega))
            return Primitive(start, end, _thinned(placed, options.grid), length, swing, commands)
    return None


def _thinned(poses: Floats, step: float) -> Floats:
    """Return poses about a step apart, without the first."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T))))
    wanted = np.linspace(0.0, along[-1], max(2, math.ceil(along[-1] / step)) + 1)[1:]
    return np.column_stack([np.interp(wanted, along, column) for column in poses.T])


def _end_points(heading: float, swing: float, options: LatticeOptions) -> Iterator[tuple[float, float]]:
    """Yield grid points that a manoeuvre with this swing may end at, the nearest first."""
    cells = int(options.longest / options.grid)
    across = np.arange(-cells, cells + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(across, across))
    distance = np.hypot(x, y)
    bearing = np.arctan2(y, x) - heading - 0.5 * swing
    off = np.abs((bearing + math.pi) % FULL_TURN - math.pi)
    widest = 1e-9 if swing == 0.0 else 0.3 * abs(swing)
    fits = (distance >= 2.0) & (distance <= 0.9 * cells) & (off <= widest)
    order = np.lexsort((off[fits], distance[fits]))
    for column, row in zip(x[fits][order].tolist(), y[fits][order].tolist(), strict=True):
        yield column * options.grid, row * options.grid


def _quarter_turned(made: Primitive, quarters: int, headings: int) -> Primitive:
    """Return the same primitive turned by quarters: the grid looks the same then."""
    x, y, yaw = made.poses.T
    for _ in range(quarters):
        x, y = -y, x
    shift = quarters * headings // 4
    poses = np.column_stack((x, y, yaw + quarters * math.pi / 2.0))
    start, end = ((place + shift) % headings for place in (made.start, made.end))
    return replace(made, start=start, end=end, poses=poses)


def _entry(number: int, made: Primitive) -> dict[str, Any]:
    """Return a primitive as the file has it; its radius is that of an arc with the same length and turn."""
    straight = made.swing == 0.0
    length = round(made.length, 5)
    radius = 0.0 if straight else made.length / abs(made.swing)
    rows = [[round(x, 5), round(y, 5), yaw % FULL_TURN] for x, y, yaw in made.poses.tolist()]
    return {
        "trajectory_id": number,
        "start_angle_index": made.start,
        "end_angle_index": made.end,
        "left_turn": straight or made.swing > 0.0,
        "trajectory_radius": round(radius, 5),
        "trajectory_length": length,
        "arc_length": 0.0 if straight else length,
        "straight_length": length if straight else 0.0,
        "poses": rows,
    }
