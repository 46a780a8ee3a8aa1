# SPDX-License-Identifier: Apache-2.0
"""What learning explains beside slip, each with its alternative: slopes, forces, limits, a car's curves."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from alternatives import CONTINUOUS, SEED, Beside, halves, held_out, level, opened, ratio, with_poses
from car_commands import best_gains, bicycle_poses, errors
from disturbed_robot import Limits, Robot, disturbed_run
from fleet_left_out import errors_on
from force_recovery import CASES, recover
from sample_cars import write_car_log
from sample_slopes import GRAVITY, Hills, hilly_log

import slipwise
from slipwise.calibration import Settings, calibrate, make_settings
from slipwise.calibration.calibrate import JUDGING_HORIZONS, calibrate_by
from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.prepared_run import WindowSet, prepare_run
from slipwise.calibration.settings_for_log import for_the_ground_of
from slipwise.calibration.statistics import held_out_half
from slipwise.logs import Log, LogOptions, Poses, Run
from slipwise.logs.log import CarCommands, Forces
from slipwise.models import Model
from slipwise.models.limits import LimitsSection

LIMITED = ("husky/tile_deflated_tyres", "drive_test/husky", "drive_test/warthog")  # limits show in these
AFTERWARDS = 1.0  # s after a command that a limit changes, in which the drive still follows it
CAR_SPEED, CAR_CURVATURE, CAR_STEERING = 8.0, 1.3, 0.41  # m/s and 1/m at full throttle and steering; rad


def motion_rows() -> Iterator[Beside]:
    """Yield all rows of this file."""
    yield from slope_rows()
    yield from force_rows()
    yield from limit_rows()
    yield from car_rows()


def pushed_by_gravity(log: Log) -> Log:
    """Return the log without roll and pitch, and the push of gravity as a known force."""
    runs = []
    for run in log.runs:
        poses = run.poses
        assert poses.roll is not None
        assert poses.pitch is not None
        along = GRAVITY * np.sin(poses.pitch)
        left = -GRAVITY * np.cos(poses.pitch) * np.sin(poses.roll)
        runs.append(replace(run, poses=level(poses), forces=Forces(poses.t, along, left)))
    return replace(log, runs=tuple(runs))


def slope_rows() -> Iterator[Beside]:
    """Terms of gravity, of a measured tilt or of a known force, beside a learner that sees neither."""
    alternative = "the same poses without roll and pitch"
    real = [opened(name)[1] for name in CONTINUOUS]
    hills = [hilly_log(SEED, Hills())]
    for where, logs, name in (("real", real, "wheel"), ("hills", hills, "command")):
        plain = [held_out(with_poses(log, level), Settings(), name) for log in logs]
        tilted = [held_out(log, Settings(), name) for log in logs]
        yield Beside("slopes", alternative, where, tuple(map(ratio, tilted, plain)))
        forced = [held_out(pushed_by_gravity(log), Settings(), name) for log in logs]
        yield Beside("known force (gravity's)", "no force", where, tuple(map(ratio, forced, plain)))


def force_rows() -> Iterator[Beside]:
    """A lumped force beside none."""
    body = make_settings({"body_force": {"frame": "body"}})
    ratios = [
        ratio(held_out(log, body, "wheel"), held_out(log, Settings(), "wheel"))
        for _, log in map(opened, CONTINUOUS)
    ]
    yield Beside("lumped force, body", "no force", "real", tuple(ratios))
    for case in CASES:
        without, with_it = recover(case, SEED).error
        where = f"MuJoCo, {case.name}"
        yield Beside(f"lumped force, {case.frame}", "no force", where, ((with_it / without, math.nan),))


def limit_rows() -> Iterator[Beside]:
    """Limits of the actuator beside the same learner without them, commands at a limit left out."""
    alternative = "no limits, spans at a limit left out"
    limits = Limits(0.08, 1.1, 0.8, 1.5), Limits(0.08, 0.6, 1.2, 2.0)
    dead = Limits(0.25), Limits(0.15)
    simulated = {
        "simulated, dead band, top speed, ramps": Robot(limits=limits),
        "simulated, dead band alone": Robot(limits=dead),
    }
    real = [from_commands(opened(name)[1]) for name in LIMITED]
    yield _of_limits(alternative, "real", real)
    for where, robot in simulated.items():
        drives = [from_commands(disturbed_run(robot, 6.0, seed=seed).log) for seed in (SEED, SEED + 1)]
        yield _of_limits(alternative, where, drives)


def from_commands(log: Log) -> Log:
    """Return the log without wheel speeds."""
    return replace(log, runs=tuple(replace(run, wheels=None) for run in log.runs))


def _of_limits(alternative: str, where: str, logs: Sequence[Log]) -> Beside:
    ratios, kept = [], 0
    for log in logs:
        first, rest = halves(log)
        model = calibrate(first, input="command").model
        limits = model.limits_section
        kept += limits is not None
        simple = without_limits(first if limits is None else within(first, limits))
        ratios.append(ratio(errors_on(rest, "command", model), errors_on(rest, "command", simple)))
    return Beside("limits", alternative, f"{where}, found on {kept} of {len(logs)}", tuple(ratios))


def without_limits(log: Log) -> Model:
    """Learn a log without looking for limits."""
    settings = for_the_ground_of(log, Settings())

    def learn(windows: WindowSet) -> Learned:
        return learn_log(windows.drive, settings, JUDGING_HORIZONS)

    return calibrate_by(learn, log, "command", settings).model


def within(log: Log, limits: LimitsSection) -> Log:
    """Return the log without the poses at or up to 1 s after a command that a limit changes."""
    return replace(log, runs=tuple(_within(run, limits) for run in log.runs))


def _within(run: Run, limits: LimitsSection) -> Run:
    assert run.commands is not None
    changed = np.zeros(len(run.commands), np.bool_)
    for axis, asked in ((limits.speed, run.commands.v), (limits.yaw_rate, run.commands.omega)):
        size = np.abs(asked)
        if axis.saturation is not None:
            changed |= size >= axis.saturation.value
        if axis.dead_band is not None:
            changed |= (size > 0.0) & (size < axis.dead_band.value)
    p = run.poses
    at = np.searchsorted(run.commands.t, p.t, side="right") - 1
    before = np.searchsorted(run.commands.t, p.t - AFTERWARDS, side="right") - 1
    counted = np.concatenate(([0], np.cumsum(changed)))
    keep = counted[np.maximum(at + 1, 0)] == counted[np.maximum(before, 0)]
    pieces = np.cumsum(~keep)  # of one piece alone are poses compared
    frame = p.frame * (len(p) + 1) + pieces
    t, x, y, yaw = (column[keep] for column in (p.t, p.x, p.y, p.yaw))
    return replace(run, poses=Poses(t=t, x=x, y=y, yaw=yaw, frame=frame[keep].astype(np.int64)))


def car_rows() -> Iterator[Beside]:
    """Curves of throttle and steering beside a bicycle whose two gains suit the first half best."""
    alternative = "a bicycle, two gains fitted to the first half"
    log = with_duty(opened("f1tenth/DS5")[1])
    yield Beside("curves of a car", alternative, "real, duty of an F1TENTH car's motor", (_of_car(log, 2.0),))
    with tempfile.TemporaryDirectory() as folder:
        path = write_car_log(Path(folder) / "car.csv", seed=SEED)
        log = slipwise.open_log(path, options=LogOptions(vehicle="dart"))
    yield Beside("curves of a car", alternative, "simulated", (_of_car(log, 2.0),))


def with_duty(log: Log) -> Log:
    """Return the log of a car whose commands are the duty of its motor and its steering."""
    (run,) = log.runs
    assert run.commands is not None
    held = np.maximum(np.searchsorted(run.extra["t"], run.commands.t, side="right") - 1, 0)
    throttle, angle = (np.nan_to_num(run.extra[name][held]) for name in ("duty", "cmd_steer"))
    steering = np.clip(angle / CAR_STEERING, -1.0, 1.0)
    car = CarCommands(throttle, steering, CAR_SPEED, CAR_CURVATURE)
    v = CAR_SPEED * throttle
    commands = replace(run.commands, v=v, omega=v * CAR_CURVATURE * steering, car=car)
    return replace(log, runs=(replace(run, commands=commands, wheels=None),))


def _of_car(log: Log, horizon: float) -> tuple[float, float]:
    (made,) = learn_log(prepare_run(log, "command"), Settings(), (horizon,)).predictions
    half = held_out_half(len(made))
    gains = best_gains(log, made, slice(0, half.start))
    measured = made.measured[half]
    return ratio(errors(measured, made.pose[half]), errors(measured, bicycle_poses(log, made, half, gains)))
