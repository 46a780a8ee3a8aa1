# SPDX-License-Identifier: Apache-2.0
"""A drive whose truth is known, written as the bags that robots in the field leave behind."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from sample_bags import EPOCH, ODOMETRY, POSE, SECOND, TWIST, Bag

from slipwise.calibration import Calibration, calibrate
from slipwise.logs import LogOptions, open_log
from slipwise.logs.log import Bools, Floats
from slipwise.models.model import Model
from slipwise.models.slip_words import slip_gains

SPEED_SHARE, TURN_SHARE = 0.95, 0.70  # of the wheels' speed and yaw rate
DELAY, LAG = 0.12, 0.25  # s, of the wheels behind commands
STEP = 0.01  # s


@dataclass(frozen=True, eq=False)
class FieldDrive:
    """What a robot was told and did, each at t [N]."""

    t: Floats  # s from the start
    command: Floats  # [N, 2] m/s, rad/s
    wheels: Floats  # [N, 2]
    pose: Floats  # [N, 3] x, y, yaw in the map
    odometry: Floats  # [N, 3] what the wheels' twist integrates to

    def every(self, seconds: float) -> range:
        """Return the places of samples that far apart."""
        return range(0, len(self.t), round(seconds / STEP))


@cache
def field_drive(
    seconds: float = 60.0,
    seed: int = 1,
    *,
    shares: tuple[float, float] = (SPEED_SHARE, TURN_SHARE),
    hold: float = 1.8,
    timeout: float = np.inf,
    period: float = 0.1,
    deadman: bool = False,
) -> FieldDrive:
    """Drive with a new command every `hold` [s], repeated every `period` [s]; it ends after `timeout` [s].

    With a `deadman` switch, none is sent where it `is_released`.
    """
    rng = np.random.default_rng(seed)
    t = STEP * np.arange(round(seconds / STEP))
    count = int(seconds / hold) + 1
    targets = np.column_stack((rng.uniform(0.1, 0.8, count), rng.uniform(-0.8, 0.8, count)))
    targets[0] = 0.0
    sent = np.round(np.floor(np.round(t / period, 9)) * period, 9)  # when the command in force was given
    if deadman:
        begun = np.round(np.floor(np.round(t / hold, 9)) * hold, 9)
        sent = np.where(is_released(t, hold), np.round(begun - period, 9), sent)
    command = targets[(np.round(sent / hold, 9)).astype(int)]
    heard = np.where((t - sent < timeout)[:, None], command, 0.0)
    late = round(DELAY / STEP)
    delayed = np.vstack((np.zeros((late, 2)), heard[:-late]))
    wheels = np.zeros_like(command)
    for k in range(1, len(t)):
        wheels[k] = wheels[k - 1] + (1.0 - np.exp(-STEP / LAG)) * (delayed[k - 1] - wheels[k - 1])
    return FieldDrive(t, command, wheels, _integrated(wheels * shares), _integrated(wheels))


def is_released(t: Floats, hold: float) -> Bools:
    """Say when an operator lets go of the stick: in every third hold."""
    return np.asarray(np.floor(np.round(t / hold, 9)) % 3 == 2)


def _integrated(twists: Floats) -> Floats:
    yaw = np.concatenate(([0.0], np.cumsum(STEP * twists[:-1, 1])))
    middle = yaw[:-1] + 0.5 * STEP * twists[:-1, 1]
    way = STEP * twists[:-1, 0]
    x, y = (np.concatenate(([0.0], np.cumsum(way * f(middle)))) for f in (np.cos, np.sin))
    return np.column_stack((x, y, yaw))


def noisy(drive: FieldDrive, seed: int = 7, xy: float = 0.008, yaw: float = 0.008) -> Floats:
    """Return the poses as a sensor measures them."""
    rng = np.random.default_rng(seed)
    return drive.pose + rng.standard_normal(drive.pose.shape) * (xy, xy, yaw)


Clock = Callable[[float], int]  # of a time from the start [s]: a stamp [ns]


def recorder(t: float) -> int:
    """The recorder's clock."""
    return EPOCH + round(t * SECOND)


def write_commands(
    bag: Bag, drive: FieldDrive, *, received: Clock = recorder, topic: str = "/cmd_vel"
) -> None:
    """Write commands without headers at 20 Hz."""
    for k in drive.every(0.05):
        bag.add(received(drive.t[k]), topic, TWIST, bag.twist(*map(float, drive.command[k])))


def write_poses(
    bag: Bag,
    drive: FieldDrive,
    *,
    received: Clock = recorder,
    stamped: Clock = recorder,
    topic: str = "/mocap/pose",
) -> None:
    """Write poses at 10 Hz."""
    poses = noisy(drive)
    for k in drive.every(0.1):
        stamp = stamped(drive.t[k])
        pose = bag.make(POSE, bag.header(stamp), bag.pose(*map(float, poses[k])))
        bag.add(received(drive.t[k]), topic, POSE, pose)


def write_wheels(
    bag: Bag,
    drive: FieldDrive,
    *,
    received: Clock = recorder,
    stamped: Clock = recorder,
    topic: str = "/odom",
) -> None:
    """Write wheel odometry at 20 Hz."""
    for k in drive.every(0.05):
        pose, twist = (tuple(map(float, each[k])) for each in (drive.odometry, drive.wheels))
        message = bag.odometry(stamped(drive.t[k]), *pose, v=twist[0], omega=twist[1])
        bag.add(received(drive.t[k]), topic, ODOMETRY, message)


def field_path(name: str) -> Path:
    """Return an input of the folder `field` beside the real logs; skip, or fail, where it is not there."""
    data = os.environ.get("SLIPWISE_DATA", "")
    path = Path(data).parent / "field" / name
    if data and path.exists():
        return path
    reason = f"SLIPWISE_DATA has no folder beside it with field/{name}"
    if os.environ.get("SLIPWISE_REQUIRE_DATA") == "1":
        pytest.fail(reason, pytrace=False)
    pytest.skip(reason)


def learned(path: Path, input_name: str | None = None, **options: object) -> tuple[Calibration, str]:
    """Calibrate a log; return the result and all that is said of the log."""
    log = open_log(path, options=LogOptions(**options))  # type: ignore[arg-type]
    said = [*log.notes, *(f"{entry.count} x {entry.reason}" for entry in log.left_out)]
    return calibrate(log, input=input_name), "\n".join(said)


def share_errors(model: Model, truth: tuple[float, float] = (SPEED_SHARE, TURN_SHARE)) -> tuple[float, float]:
    """Return by how many standard deviations the learned shares of speed and yaw rate miss the truth."""
    gains = slip_gains(model)
    both = zip((gains.speed, gains.yaw_rate), truth, strict=True)
    speed, yaw_rate = ((gain.value - true) / gain.std for gain, true in both)
    return speed, yaw_rate
