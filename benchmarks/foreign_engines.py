# SPDX-License-Identifier: Apache-2.0
"""Drives in engines whose physics is not ours: Bullet's Husky, and a 1:10 car in slipx, as tidy logs."""

from __future__ import annotations

import contextlib
import importlib
import math
import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

INPUT_RATE = 20.0  # Hz; poses come at half of it
COLUMNS = "t,cmd_v,cmd_omega,odo_v,odo_omega,x,y,yaw"
WHEEL_RADIUS, TRACK = 0.17775, 0.5708  # m, of the Husky
POSE_STD = (0.014, 0.01)  # m, rad
BACKWARD = 0.3  # of the greatest speed


@dataclass(frozen=True)
class Husky:
    """A drive of Bullet's own Husky."""

    lag: float = 0.0  # s, of the speeds that the wheels are given
    payload: float = 0.0  # kg on the body
    torque: float = 200.0  # N m that a motor has
    friction: float = 1.0  # of the wheels
    friction_later: float | None = None  # in the second half
    speed: float = 1.0  # m/s, greatest
    yaw_rate: float = 1.5  # rad/s, greatest


@dataclass(frozen=True)
class Car:
    """A drive of the reference car of slipx: double track, tyres with relaxation, a locked rear axle."""

    speed: float  # m/s, greatest
    steering: float = 0.35  # rad, greatest
    mass: float | None = None  # kg
    grip: float = 1.0  # factor of the friction of all tyres
    grip_later: float | None = None  # in the second half


def engine(name: str) -> Any:
    """Import an engine; a missing one ends the benchmark with code 2 and says what to do."""
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        advice = "pip install -r benchmarks/requirements-foreign.txt"
        print(f"{name} is missing ({problem}): {advice}", file=sys.stderr)
        raise SystemExit(2) from problem


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Keep what an engine prints of its own away from the tables."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("wb") as nothing:
        os.dup2(nothing.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def write_drive(drive: Husky | Car, path: Path, *, seed: int, minutes: float) -> Path:
    """Drive, and write the log."""
    rng = np.random.default_rng(seed)
    periods = int(minutes * 60.0 * INPUT_RATE)
    with _silent():
        rows = (
            _husky_rows(drive, rng, periods) if isinstance(drive, Husky) else _car_rows(drive, rng, periods)
        )
    rows[:, 4:6] += rng.normal(0.0, POSE_STD[0], (periods, 2))
    rows[:, 6] = np.angle(np.exp(1j * (rows[:, 6] + rng.normal(0.0, POSE_STD[1], periods))))
    lines = [COLUMNS]
    for k, row in enumerate(rows):
        numbers = [f"{value:.5f}" for value in (row if k % 2 == 0 else row[:4])]
        lines.append(",".join([f"{k / INPUT_RATE:.3f}", *numbers, *[""] * (7 - len(numbers))]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _held(
    rng: np.random.Generator, periods: int, draw: Callable[[], Any], least: float, most: float
) -> Floats:
    """Random commands, each held for `least` to `most` seconds."""
    commands, k = np.zeros((periods, 2)), 0
    while k < periods:
        held = max(1, int(rng.uniform(least, most) * INPUT_RATE))
        commands[k : k + held] = draw()
        k += held
    return commands


def _husky_commands(drive: Husky, rng: np.random.Generator, periods: int) -> Floats:
    def draw() -> tuple[float, float]:
        v = rng.uniform(-BACKWARD * drive.speed, drive.speed)
        omega = rng.uniform(-drive.yaw_rate, drive.yaw_rate)
        return ((v, omega), (v, omega), (v, omega), (v, 0.0), (0.0, omega))[rng.integers(5)]

    return _held(rng, periods, draw, 1.5, 4.0)


def _husky_rows(drive: Husky, rng: np.random.Generator, periods: int) -> Floats:
    bullet, step = engine("pybullet"), 1.0 / 240.0
    bullet.connect(bullet.DIRECT)
    try:
        bullet.setAdditionalSearchPath(engine("pybullet_data").getDataPath())
        bullet.setGravity(0.0, 0.0, -9.81)
        bullet.setTimeStep(step)
        bullet.loadURDF("plane.urdf")
        robot = bullet.loadURDF("husky/husky.urdf", [0.0, 0.0, 0.15])
        joints = [bullet.getJointInfo(robot, j) for j in range(bullet.getNumJoints(robot))]
        wheels = [info[0] for info in joints if info[2] == bullet.JOINT_REVOLUTE]
        sides = np.array([-1.0 if b"left" in info[1] else 1.0 for info in joints if info[0] in wheels])
        mass = bullet.getDynamicsInfo(robot, -1)[0]
        bullet.changeDynamics(robot, -1, mass=mass + drive.payload)

        def slide(friction: float) -> None:
            for wheel in wheels:
                bullet.changeDynamics(robot, wheel, lateralFriction=friction)

        slide(drive.friction)
        commands, given, rows = _husky_commands(drive, rng, periods), np.zeros(2), []
        answered = 1.0 - math.exp(-step / drive.lag) if drive.lag > 0.0 else 1.0
        for k, asked in enumerate(commands):
            if drive.friction_later is not None and k == periods // 2:
                slide(drive.friction_later)
            for _ in range(round(1.0 / (INPUT_RATE * step))):
                given = given + (asked - given) * answered
                speeds = (given[0] + sides * given[1] * TRACK / 2.0) / WHEEL_RADIUS
                for wheel, speed in zip(wheels, speeds, strict=True):
                    bullet.setJointMotorControl2(
                        robot, wheel, bullet.VELOCITY_CONTROL, targetVelocity=speed, force=drive.torque
                    )
                bullet.stepSimulation()
            turning = np.array([bullet.getJointState(robot, w)[1] for w in wheels]) * WHEEL_RADIUS
            left, right = turning[sides < 0.0].mean(), turning[sides > 0.0].mean()
            place, quaternion = bullet.getBasePositionAndOrientation(robot)
            yaw = bullet.getEulerFromQuaternion(quaternion)[2]
            rows.append([*asked, (left + right) / 2.0, (right - left) / TRACK, place[0], place[1], yaw])
        return np.array(rows)
    finally:
        bullet.disconnect()


def _car_model(slipx: Any, drive: Car, grip: float) -> tuple[Any, Any]:
    made = slipx.load_reference_car().params
    made.differential = slipx.Differential.Spool
    made.mass = made.mass if drive.mass is None else drive.mass
    for tyre in (made.tyre_front, made.tyre_rear):
        tyre.mu_x0 *= grip
        tyre.mu_y0 *= grip
    return slipx.VehicleModel.create(slipx.Tier.L2_DoubleTrack, made), made


def _car_rows(drive: Car, rng: np.random.Generator, periods: int) -> Floats:
    slipx, step = engine("slipx"), 1e-3
    model, made = _car_model(slipx, drive, drive.grip)
    state, diagnostics, rows = slipx.VehicleState(), slipx.StepDiagnostics(), []
    commands = _held(
        rng,
        periods,
        lambda: (rng.uniform(0.5, drive.speed), rng.uniform(-drive.steering, drive.steering)),
        1.0,
        3.0,
    )
    for k, (speed, angle) in enumerate(commands.tolist()):
        if drive.grip_later is not None and k == periods // 2:
            model, made = _car_model(slipx, drive, drive.grip_later)
        for _ in range(round(1.0 / (INPUT_RATE * step))):
            asked = slipx.DriveInput()
            asked.steer_cmd, asked.accel_cmd = angle, slipx.hold_speed(state, speed)
            model.step(state, asked, step, diagnostics)
        rolled = float(np.mean([state.omega_w[i] for i in (2, 3)])) * made.wheel_radius
        rows.append(
            [
                speed,
                speed * math.tan(angle) / made.wheelbase,
                rolled,
                rolled * math.tan(state.steer) / made.wheelbase,
                state.pos.x - made.lr * math.cos(state.yaw),  # the rear axle
                state.pos.y - made.lr * math.sin(state.yaw),
                state.yaw,
            ]
        )
    return np.array(rows)
