# SPDX-License-Identifier: Apache-2.0
"""Which columns of a tidy table mean what, and what to say when they are missing."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.column_names import listed
from slipwise.logs.findings.finding import Notes
from slipwise.logs.findings.wheel_layout import layout_findings
from slipwise.logs.kinematics import omega_from_curvature, twist_from_steering, twist_from_wheels
from slipwise.logs.left_out import Tally
from slipwise.logs.log import OPTIONAL_POSE_COLUMNS, Floats
from slipwise.logs.options import LogOptions
from slipwise.logs.table import Columns
from slipwise.logs.vehicle_description import VehicleDescription
from slipwise.logs.vocabulary import POSE_COLUMNS, SHARED, measured_by
from slipwise.logs.wheel_readings import twists_of_wheels, wheel_names

MEASURED_BESIDE = tuple(name for name in OPTIONAL_POSE_COLUMNS if name != "fix")  # numbers beside a pose
FORCE = ("force_x", "force_y")
CAR = ("throttle", "steering")  # commands without units of a car
#: Columns whose numbers are in the streams of a log; others are carried along beside them.
USED = frozenset(column.name for column in SHARED) - {"cmd_vy"} | {"source", *OPTIONAL_POSE_COLUMNS, *FORCE}
_SIZES = "--wheel-radius and --wheel-separation"
_AN_INPUT = "cmd_v and cmd_omega, or odo_v and odo_omega"
_NUMBERED = "t=0,odo_v=1,odo_omega=2"
_BESIDE = {  # what a column of wheels is used with
    "odo_v": "odo_omega",
    "odo_vy": "odo_v and odo_omega",
    "odo_omega": "odo_v",
    "wheel_left": "wheel_right",
    "wheel_right": "wheel_left",
}
_SAME_SPEED = 1e-6  # [m/s] cmd_vx and cmd_v are the same column under two names below this


@dataclass(frozen=True)
class InputColumns:
    """A twist per row [N], NaN where the row has none."""

    v: Floats
    vy: Floats | None
    omega: Floats
    ended: Floats | None = None  # 1 where nobody sent it: the command before is held, or ended

    def columns(self) -> dict[str, Floats]:
        """Return the columns by name, without a sideways speed where there is none."""
        twist = {"v": self.v, "omega": self.omega}
        return twist if self.vy is None else {**twist, "vy": self.vy}


def require_columns(table: Columns, *, poses: bool, described: bool = False, car: bool = False) -> None:
    """Check that the table has a time, some input and, where `poses` come from it, a pose.

    Wheels of a vehicle that is `described` are looked for when they are read. A `car` is commanded by
    throttle and steering.

    Raises:
        LogError: it does not; the error names what is missing and what was found.
    """
    names = table.names
    poses = poses and ("gyro_z" not in names or bool({"x", "y"} & set(names)))  # turns of a gyro may be all
    missing = [name for name in ("t", *(("x", "y") if poses else ())) if name not in names]
    commands = _commands_there(names, car=car)
    wheels = "odo_v" in names or ("wheel_left" in names and "wheel_right" in names)
    driven = commands or wheels or described
    if not driven:
        alone = "cmd_curvature" in names  # without a speed it is no motion
        missing.append("cmd_v, the speed that cmd_curvature is driven at" if alone else _AN_INPUT)
    beside = f"LOG --poses {table.path.name}"
    if not driven and {"tx", "ty"} <= set(names):  # as evo writes poses
        raise LogError(
            "this is a table of poses, without commands or wheel speeds",
            where=str(table.path),
            advice=f"give the log that goes with it, and this file beside it: {beside}",
        )
    positions = not driven and {"x", "y"} <= set(names)
    if missing and not table.named:
        raise LogError(
            f"a table of {len(names)} columns of numbers without names",
            where=str(table.path),
            advice=f"say which is which by number, from 0 to {len(names) - 1}, such as --columns {_NUMBERED}"
            + (", and x, y, yaw, or give --poses FILE" if poses else "")
            + (f"; the comment above them is: {table.comment}" if table.comment else ""),
        )
    if missing:
        raise LogError(
            f"missing columns: {'; '.join(missing)}",
            where=str(table.path),
            advice=f"found {listed(names)}; say which is which, such as --columns t=time,cmd_v=vx"
            + (", or give --poses FILE" if poses and "x" in missing else "")
            + (f"; poses alone go beside a log: {beside}" if positions else ""),
        )


def command_columns(table: Columns, options: LogOptions, tally: Tally, notes: Notes) -> InputColumns | None:
    """Return the commanded twist per row, or None where the table has no command."""
    found = _commanded(table, options, tally, notes)
    if found is None or "cmd_ended" not in table.names:
        return found
    return replace(found, ended=table.numbers("cmd_ended", tally))


def _commanded(table: Columns, options: LogOptions, tally: Tally, notes: Notes) -> InputColumns | None:
    """Return the commanded twist per row, or None where the table has no command.

    `cmd_vy` is the sideways partner of `cmd_vx`. Where a table also has a `cmd_v` that differs from `cmd_vx`,
    `cmd_v` is the speed along the direction of travel and already holds both, so nothing is added to it.
    """
    names = table.names
    forward = "cmd_v" if "cmd_v" in names else "cmd_vx"
    if options.car is not None and {*CAR} <= set(names):
        throttle, steering = (table.numbers(name, tally) for name in CAR)
        return InputColumns(throttle, None, steering)
    if commanded_by_direction(table, options):
        notes.append(f"{table.path.name}: cmd_vx and cmd_vy from cmd_v along cmd_dir")
        speed, along = table.numbers("cmd_v", tally), table.numbers("cmd_dir", tally)
        turn = table.numbers("cmd_omega", tally) if "cmd_omega" in names else np.zeros(len(table))
        return InputColumns(speed * np.cos(along), speed * np.sin(along), turn)
    if forward not in names:
        notes += [f"{table.path.name}: {alone}" for alone in _without_speed(table, options)]
        return None
    v = table.numbers(forward, tally)
    v, omega = _turning_commands(table, v, options, tally, notes)
    if omega is None:
        if "odo_v" in names or "wheel_left" in names:
            notes.append(f"{table.path.name}: {forward} has no cmd_omega beside it and is not used")
            return None
        _raise_no_omega(table, "cmd_omega", steer="cmd_steer" in names)
    vy = table.numbers("cmd_vy", tally) if "cmd_vy" in names else None
    if vy is not None and forward == "cmd_v" and "cmd_vx" in names:
        apart = np.abs(table.numbers("cmd_vx", tally) - v) > _SAME_SPEED
        if apart.any():
            notes.append(
                f"{table.path.name}: cmd_v differs from cmd_vx, so it is taken as the speed along the "
                "direction of travel and cmd_vy is not added to it"
            )
            vy = None
    return InputColumns(v, vy, omega)


def _without_speed(table: Columns, options: LogOptions) -> list[str]:
    """Say which columns of commands are not used where none of them is a speed."""
    there = [name for name in table.names if measured_by(name) == "command"]
    pedals = [name for name in there if name in CAR]
    found = [f"{name} has no cmd_v beside it and is not used" for name in there if name not in pedals]
    if pedals and options.car is None:
        found.append(f"{' and '.join(pedals)} are used with --vehicle: a car whose sizes are known")
    elif pedals:
        found.append(f"{pedals[0]} is used where throttle and steering are both there")
    return found


def _commands_there(names: Collection[str], *, car: bool) -> bool:
    return bool({"cmd_v", "cmd_vx"} & set(names)) or (car and {*CAR} <= set(names))


def commanded_by_direction(table: Columns, options: LogOptions) -> bool:
    """Whether a vehicle that drives sideways is commanded by a speed and a direction to its x axis."""
    return options.sideways and {"cmd_v", "cmd_dir"} <= set(table.names)


def wheel_columns(table: Columns, options: LogOptions, tally: Tally, notes: Notes) -> InputColumns | None:
    """Return the twist measured at the wheels per row, or None where the table has none."""
    names = table.names
    if "odo_v" in names and "odo_omega" in names:
        vy = table.numbers("odo_vy", tally) if "odo_vy" in names else None
        return InputColumns(table.numbers("odo_v", tally), vy, table.numbers("odo_omega", tally))
    commanded = _commands_there(names, car=options.car is not None)
    if options.wheels is not None and commanded and not any(name.startswith("wheel_") for name in names):
        notes.append(f"{table.path.name}: there are no speeds of the wheels of {options.vehicle}")
        return None
    if options.wheels is not None:
        return _layout_columns(table, options, options.wheels, tally, notes)
    if "wheel_left" in names and "wheel_right" in names:
        if options.wheel_radius is not None and options.wheel_separation is not None:
            left, right = table.numbers("wheel_left", tally), table.numbers("wheel_right", tally)
            v, omega = twist_from_wheels(
                left, right, wheel_radius=options.wheel_radius, wheel_separation=options.wheel_separation
            )
            notes.append(
                f"{table.path.name}: odo from wheel radius {options.wheel_radius} m,"
                f" separation {options.wheel_separation} m"
            )
            return InputColumns(v, None, omega)
        if not commanded:
            advice = f"give {_SIZES}, or the columns odo_v and odo_omega"
            raise LogError(
                "wheel speeds need the wheel radius and the wheel_separation",
                where=str(table.path),
                advice=advice,
            )
        notes.append(
            f"{table.path.name}: wheel_left and wheel_right have wheel speeds: give {_SIZES} to use them"
        )
        return None
    if "odo_v" in names and not commanded:
        _raise_no_omega(table, "odo_omega", steer=False)
    alone = [name for name in ("odo_v", "odo_vy", "odo_omega", "wheel_left", "wheel_right") if name in names]
    notes += [f"{table.path.name}: {name} has no {_BESIDE[name]} beside it and is not used" for name in alone]
    return None


def _layout_columns(
    table: Columns, options: LogOptions, vehicle: VehicleDescription, tally: Tally, notes: Notes
) -> InputColumns:
    try:
        names = wheel_names(vehicle, table.names)
    except LogError as error:
        raise LogError(error.what, where=str(table.path), advice=error.advice) from error
    readings = {name: table.numbers(name, tally) for name in names.all}
    t = table.numbers("t", tally)
    found = twists_of_wheels(vehicle, names, readings, t)
    notes.append(f"{table.path.name}: {found.note(str(options.vehicle))}")
    notes += layout_findings(vehicle, names, readings, t)
    return InputColumns(found.v, found.vy, found.omega)


def missing_input(table: Columns, wheels: InputColumns | None) -> dict[str, str]:
    """Return what would give an input that the table could have, by the input's name."""
    if wheels is not None or not {"wheel_left", "wheel_right"} <= set(table.names):
        return {}
    return {"wheel": f"wheel_left and wheel_right have wheel speeds: give {_SIZES} to use them"}


def use_of_column(name: str, names: Collection[str], options: LogOptions) -> tuple[str, str]:
    """Return what a column is used as (empty: not used) and why."""
    described = () if options.wheels is None else options.wheels.names
    of = measured_by(name, described)
    if not of:
        return "", "slipwise has no such column; --columns gives it another name"
    if name in POSE_COLUMNS and options.poses is not None:
        return "", "--poses gives the poses"
    why = _unused_because(name, names, options) if of in ("command", "wheel") else ""
    return ("", why) if why else (of, "")


def _unused_because(name: str, names: Collection[str], options: LogOptions) -> str:
    sized = options.wheel_radius is not None and options.wheel_separation is not None
    beside = {"odo_v": "odo_omega", "odo_omega": "odo_v"}.get(name, name)
    if beside not in names:
        return f"there is no {beside} beside it"
    if name in CAR and options.car is None:
        return "a car's commands without units need --vehicle"
    if name == "cmd_vx" and "cmd_v" in names:
        return "cmd_v is used"
    if name == "cmd_steer" and options.wheelbase is None:
        return "a steering angle needs --wheelbase"
    if name in ("wheel_left", "wheel_right"):
        if {"odo_v", "odo_omega"} <= set(names):
            return "odo_v and odo_omega are used"
        return "" if sized else f"wheel speeds need {_SIZES}"
    return ""


def _turning_commands(
    table: Columns, v: Floats, options: LogOptions, tally: Tally, notes: Notes
) -> tuple[Floats, Floats | None]:
    """Take cmd_omega; where it is empty the curvature (thesis 3.2), and then the steering angle."""
    names, (factor, _) = table.names, options.command_scale
    omega = table.numbers("cmd_omega", tally) if "cmd_omega" in names else None
    if "cmd_curvature" in names:
        turned = omega_from_curvature(v, table.numbers("cmd_curvature", tally), speed_factor=factor)
        omega = _filled(omega, turned, f"{table.path.name}: cmd_omega from cmd_curvature and speed", notes)
    if "cmd_steer" in names and options.wheelbase is not None:
        angle = table.numbers("cmd_steer", tally)
        speed, steered = twist_from_steering(v, angle, wheelbase=options.wheelbase, speed_factor=factor)
        note = f"{table.path.name}: cmd_omega from cmd_steer and wheelbase {options.wheelbase} m"
        if omega is not None:  # at a standstill it is 0, and the angle says how the wheels are turned
            omega = np.where((v == 0.0) & (omega == 0.0) & np.isfinite(steered), steered, omega)
        v = speed if omega is None else np.where(np.isnan(omega) | (omega == steered), speed, v)
        omega = _filled(omega, steered, note, notes)
    return v, omega


def _filled(omega: Floats | None, other: Floats, note: str, notes: Notes) -> Floats:
    """Fill what is empty of `omega`, and note it where something was."""
    filled = other if omega is None else np.where(np.isnan(omega), other, omega)
    if omega is None or bool((np.isnan(omega) & ~np.isnan(filled)).any()):
        notes.append(note)
    return filled


def _raise_no_omega(table: Columns, missing: str, *, steer: bool) -> NoReturn:
    turns = f"add a column {missing} [rad/s]" + (" or cmd_curvature [1/m]" if missing == "cmd_omega" else "")
    advice = "give --wheelbase in metres, the table has cmd_steer" if steer else turns
    raise LogError(f"missing columns: {missing}", where=str(table.path), advice=advice)
