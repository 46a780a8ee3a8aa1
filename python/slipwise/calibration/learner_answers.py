# SPDX-License-Identifier: Apache-2.0
"""What a learner has to say, and where it thinks that the robot will be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.learner import STRUCTURES

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


@dataclass(frozen=True, eq=False)
class PredictedPath:
    """Where base_link will be, in the frame of its pose at the start."""

    start: float  # s, stamp of the newest measurement
    t: Floats  # [N] s, stamps of the poses; the last is at the horizon
    poses: Floats  # [N, 3] x, y [m], yaw [rad], the yaw not wrapped
    covariance: Floats  # [N, 3, 3] of a Student t each
    dof: Floats  # [N] its degrees of freedom; few are heavy tails
    structure: str  # of the model that predicts: "joint", "cascaded", "direct" or "baseline"


def path_of(path: _core.PredictedPath) -> PredictedPath:
    """Return a path of the core."""
    return PredictedPath(
        start=path.start,
        t=np.array(path.t),
        poses=np.array(path.poses),
        covariance=np.array(path.covariances),
        dof=np.array([student.dof for student in path.students]),
        structure=STRUCTURES[path.structure],
    )


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
