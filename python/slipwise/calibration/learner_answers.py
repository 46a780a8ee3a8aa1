# SPDX-License-Identifier: Apache-2.0
"""What a learner has to say: events, where the robot is, and whether it moves as it must."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

_KINDS = {
    _core.EventKind.SegmentLearned: "segment-learned",
    _core.EventKind.Rejected: "rejected",
    _core.EventKind.TerrainChange: "terrain-change",
    _core.EventKind.HeldOut: "held-out",
    _core.EventKind.Refit: "refit",
}


@dataclass(frozen=True)
class Event:
    """Something that a learner has to say."""

    kind: str  # "segment-learned", "rejected", "terrain-change", "held-out" or "refit"
    run: str
    t: float  # s
    reason: str = ""  # why something was rejected
    nis: float | None = None  # of a segment learned: its normalised innovation squared, 3 degrees of freedom


def event_of(event: _core.LearnerEvent, run: str) -> Event:
    """Return an event of the core, in the run of that name, in words."""
    kinds = _core.EventKind
    return Event(
        _KINDS[event.kind],
        run,
        event.t,
        event.reason_text if event.kind == kinds.Rejected else "",
        _nis(event) if event.kind == kinds.SegmentLearned else None,
    )


def _nis(event: _core.LearnerEvent) -> float:
    """The NIS of the structure that predicts."""
    return float(event.updates[int(np.argmax(event.weights))].nis)


@dataclass(frozen=True, eq=False)
class Odometry:
    """Where the robot is and how it moves, in the conventions of nav_msgs/Odometry."""

    t: float  # s, stamp of the newest measurement
    pose: Floats  # [3] x, y [m], yaw [rad] in (-pi, pi], of base_link
    covariance: Floats  # [3, 3] of the pose, in the axes of the frame
    twist: Floats  # [3] v, vy [m/s], omega [rad/s] of base_link, slip included
    twist_covariance: Floats  # [3, 3]
    since_pose: float  # s since the last pose that was used was measured
    frame: int  # of that pose


@dataclass(frozen=True)
class MotionState:
    """How the robot moves beside what its inputs and the learned model say it must."""

    stuck: bool  # it does not move although it must
    fraction: float | None  # of the motion expected of the last 0.6 s; None where too little to tell
    since: float | None  # s, stamp at which it was first seen to be stuck; None where it is not


def odometry_of(found: _core.Odometry) -> Odometry:
    """Return what the core found, with the yaw wrapped."""
    return Odometry(
        t=found.t,
        pose=np.array([found.pose.x, found.pose.y, _core.wrap_angle(found.pose.theta)]),
        covariance=np.array(found.covariance),
        twist=np.array(found.twist),
        twist_covariance=np.array(found.twist_covariance),
        since_pose=found.since_pose,
        frame=found.frame,
    )
