# SPDX-License-Identifier: Apache-2.0
"""What tests of several sources of poses share: one drive, and what each source measures of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from sample_positions import BASIS, SECONDS, SLIP, commands

from slipwise.calibration import make_settings
from slipwise.logs import Poses, Run
from slipwise_sim.known_robot import KnownRobot, known_run

SETTINGS = make_settings({"basis": "full-linear-6"})
LOST = 20.0  # s after which a source is lost


@dataclass(frozen=True)
class Source:
    """A source of poses: its errors, its lateness, and where it sits."""

    std: tuple[float, float] = (0.01, 0.005)  # m, rad
    late: float = 0.0  # s
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    every: int = 1  # of the drive's poses


def true_run(seed: int) -> tuple[Run, np.random.Generator]:
    """Return a drive from wheels whose poses are exact, and what draws further."""
    random = np.random.default_rng(seed)
    robot = KnownRobot(lag=(0.2, 0.3), delay=(0.1, 0.15), basis=BASIS, slip=SLIP, pose_std=(0.0, 0.0))
    return known_run(robot, commands(random), (0.0, SECONDS), random=random), random


def seen_by(poses: Poses, source: Source, random: np.random.Generator) -> Poses:
    """Return what a source measures of exact poses."""
    t, x, y, yaw = (column[:: source.every] for column in (poses.t, poses.x, poses.y, poses.yaw))
    ahead, left, turned = source.sensor
    noise = random.standard_normal((3, len(t)))
    return Poses(
        t=t + source.late,
        x=x + ahead * np.cos(yaw) - left * np.sin(yaw) + source.std[0] * noise[0],
        y=y + ahead * np.sin(yaw) + left * np.cos(yaw) + source.std[0] * noise[1],
        yaw=yaw + turned + source.std[1] * noise[2],
        frame=np.zeros(len(t), np.int64),
    )


def until_lost(poses: Poses) -> Poses:
    """Return the poses of the first `LOST` seconds."""
    keep = poses.t < LOST
    t, x, y, yaw = (column[keep] for column in (poses.t, poses.x, poses.y, poses.yaw))
    return Poses(t=t, x=x, y=y, yaw=yaw, frame=poses.frame[keep])


def run_of(run: Run, first: Poses, **others: Poses) -> Run:
    """Return the drive as these sources measure it."""
    return replace(run, poses=first, others=others, source="first" if others else "")
