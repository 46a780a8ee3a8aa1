# SPDX-License-Identifier: Apache-2.0
"""Odometry and the path ahead, in the frame of the measured poses."""

from __future__ import annotations

import numpy as np

from slipwise import _core
from slipwise.calibration.motion_learner import MotionLearner
from slipwise.calibration.path_ahead import PredictedPath
from slipwise.live.outputs import Floats, Odometry, Path
from slipwise.live.samples import Pose

DEFAULT_FRAME = "odom"
CHILD_FRAME = "base_link"


def odometry_of(learner: MotionLearner, newest: Pose | None) -> Odometry | None:
    """Return where the robot is and how it moves; None before the first pose."""
    now = learner.odometry() if newest is not None else None
    if now is None or newest is None:
        return None
    return Odometry(
        t=now.t,
        frame=newest.frame or DEFAULT_FRAME,
        child_frame=CHILD_FRAME,
        pose=now.pose,
        pose_covariance=now.covariance,
        twist=now.twist,
        twist_covariance=now.twist_covariance,
        since_pose=now.since_pose,
    )


def path_ahead(
    learner: MotionLearner, odometry: Odometry, commands: Floats, *, horizon: float, asked: bool = False
) -> Path:
    """Return where the robot will be, placed at its pose now.

    Args:
        learner: predicts.
        odometry: the pose now.
        commands: what the robot will be given, rows of t [s] and the learner's `axes`.
        horizon: how far to predict [s].
        asked: whether a request asked for it.

    Raises:
        SettingsError: nothing was measured yet, or the commands or the horizon are impossible.
    """
    ahead = learner.predict(commands, horizon=horizon)
    start = _core.Pose2(*odometry.pose.tolist())
    placed = [_core.compose(start, _core.Pose2(*pose)).vector() for pose in ahead.poses.tolist()]
    return Path(
        t=np.concatenate(([ahead.start], ahead.t)),
        frame=odometry.frame,
        poses=np.vstack((odometry.pose, placed)),
        covariance=np.concatenate((odometry.pose_covariance[None], _placed_covariance(odometry, ahead))),
        asked=asked,
    )


def _placed_covariance(odometry: Odometry, ahead: PredictedPath) -> Floats:
    """Of a pose composed with an independent one, both with covariances in the axes of their frame."""
    c, s = np.cos(odometry.pose[2]), np.sin(odometry.pose[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    found = []
    for pose, covariance in zip(ahead.poses, ahead.covariance, strict=True):
        carried = np.eye(3)
        carried[:2, 2] = (-s * pose[0] - c * pose[1], c * pose[0] - s * pose[1])
        found.append(carried @ odometry.pose_covariance @ carried.T + turn @ covariance @ turn.T)
    return np.array(found)
