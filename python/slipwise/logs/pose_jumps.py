# SPDX-License-Identifier: Apache-2.0
"""Finds poses that jump further than the robot can have moved; drops lone ones, splits frames at others."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from slipwise import _core
from slipwise.logs.log import Bools, Floats, Inputs, Ints, Poses


@dataclass(frozen=True, eq=False)
class Jumps:
    """What was found: poses to drop, poses that start a new frame, and the frames of those that stay."""

    dropped: Bools  # [M]
    starts: Bools  # [M]
    frame: Ints  # [M] of the poses; meaningless where they are dropped


def find_jumps(poses: Poses, inputs: Inputs, unknown_after: float) -> Jumps:
    """Find jumps as the learner does while it drives: from what was measured until then.

    An input is unknown once it is older than `unknown_after` [s].
    """
    recording = _core.Recording(np.empty((0, 4)), inputs.rows(), np.empty((0, 3)), poses.rows())
    gated = _core.gate_poses(recording, unknown_after)
    accepted = np.asarray(gated.accepted)
    frame = np.zeros(len(poses), dtype=np.int64)
    frame[_places(poses, accepted[:, 0])] = accepted[:, 4].astype(np.int64)
    dropped, starts = np.zeros(len(poses), bool), np.zeros(len(poses), bool)
    dropped[_places(poses, np.asarray(gated.outliers)[:, 0])] = True
    starts[_places(poses, np.asarray(gated.jumps)[:, 0])] = True
    return Jumps(dropped, starts, frame)


def _places(poses: Poses, stamps: Floats) -> Ints:
    """Return where poses with these stamps are."""
    return np.asarray(np.searchsorted(poses.t, stamps), dtype=np.int64)


def without_jumps(poses: Poses, jumps: Jumps) -> Poses:
    """Drop the lone outliers, and give the poses after each lasting jump a frame of their own.

    The poses as measured go along: a learner finds the jumps when it would have on a robot.
    """
    keep = ~jumps.dropped
    clean = replace(poses.select(keep), frame=jumps.frame[keep])
    object.__setattr__(clean, "measured", poses)
    return clean
