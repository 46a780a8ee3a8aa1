# SPDX-License-Identifier: Apache-2.0
"""A robot that circles over ground one half of which slips more than its predictions expect."""

from __future__ import annotations

import numpy as np

from slipwise.calibration.predictions import Predictions
from slipwise.logs.log import Inputs, Log, Poses, Run

RADIUS, LAP, LAPS, WINDOW = 5.0, 60.0, 4, 1.0
SLIPPERY, FIRM = -0.10, 0.02  # forward slip that was not expected, where x < 0 and elsewhere


def circling(laps: int = LAPS) -> tuple[Log, Predictions]:
    """Return the drive, and predictions of windows of 1 s with errors of 1 % beside the ground's own."""
    rng = np.random.default_rng(3)
    t = np.arange(0.0, laps * LAP + 0.05, 0.1)
    angle = 2.0 * np.pi * t / LAP
    poses = Poses(
        t=t,
        x=RADIUS * np.cos(angle),
        y=RADIUS * np.sin(angle),
        yaw=np.angle(np.exp(1j * (angle + np.pi / 2))),
        frame=np.zeros(len(t), np.int64),
    )
    start = np.arange(0.0, laps * LAP - WINDOW, WINDOW)
    way, turn = 2.0 * np.pi * RADIUS / LAP * WINDOW, 2.0 * np.pi / LAP * WINDOW
    slip = np.where(np.cos(2.0 * np.pi * (start + 0.5) / LAP) < 0.0, SLIPPERY, FIRM)
    pose = np.tile([way, 0.0, turn], (len(start), 1))
    measured = pose + np.column_stack((slip * way, np.zeros(len(start)), np.zeros(len(start))))
    measured += 0.01 * way * rng.standard_normal(measured.shape)
    count = len(start)
    part = Predictions(
        method="auto",
        horizon=WINDOW,
        run=np.zeros(count, np.int64),
        t_start=start,
        t_end=start + WINDOW,
        pose=pose,
        covariance=np.tile(1e-4 * np.eye(3), (count, 1, 1)),
        inflation=np.ones(count),
        dof=np.full(count, 30.0),
        nominal_nis=np.ones(count),
        structure=np.zeros(count, np.int64),
        measured=measured,
        learned_until=start,
        in_sample=np.zeros((count, 2)),
    )
    inputs = Inputs(t=t, v=np.full(len(t), way), vy=np.zeros(len(t)), omega=np.full(len(t), turn))
    return Log((Run("circles", None, inputs, poses),)), part
