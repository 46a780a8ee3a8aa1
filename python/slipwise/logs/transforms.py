# SPDX-License-Identifier: Apache-2.0
"""Poses from TF: the chain of transforms from a fixed frame to the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.log import Floats, Ints
from slipwise.logs.messages import stamp_of
from slipwise.logs.rotation import product, rotate

_FIXED = ("map", "world", "mocap", "utm")
_ROBOT = ("base_link", "base_footprint")
_OFTEN = 0.5  # of all poses; a localiser that corrects less often leaves the rest to odometry

Edge = tuple[str, str]  # parent, child


@dataclass(frozen=True)
class TransformSource:
    """What TF knows of the robot's pose."""

    name: str  # the topic
    frames: tuple[str, str] | None  # fixed frame and robot, None where there are none
    samples: int  # poses
    odometry_alone: bool  # nothing above the odometry's frame ever moves
    problem: str = ""  # why there are no poses
    warning: str = ""  # what these poses do not show


class TransformCollector:
    """Collects all transforms of TF topics by parent and child."""

    def __init__(self) -> None:
        self._edges: dict[Edge, list[tuple[int, tuple[float, ...]]]] = {}
        self._static: set[Edge] = set()

    def add(self, message: Any, received_ns: int, *, static: bool) -> None:
        """Take one message; transforms without a stamp are dated by when they were received.

        Raises:
            Exception: one of `WRONG_CONTENT`, at the first transform that is none.
        """
        for transform in message.transforms:
            stamp = stamp_of(transform.header)
            edge = (transform.header.frame_id.strip("/"), transform.child_frame_id.strip("/"))
            p, q = transform.transform.translation, transform.transform.rotation
            x, y, z, qx, qy, qz, qw = map(float, (p.x, p.y, p.z, q.x, q.y, q.z, q.w))
            row = (x, y, z, qx, qy, qz, qw)
            self._edges.setdefault(edge, []).append((stamp or received_ns, row))
            if static:
                self._static.add(edge)

    def edges(self) -> Mapping[Edge, tuple[Ints, Floats]]:
        """Return stamps [N] in ns and (x, y, z, qx, qy, qz, qw) [N, 7] of each edge, sorted by stamp."""
        sorted_edges = {}
        for edge, samples in self._edges.items():
            stamps = np.array([stamp for stamp, _ in samples], dtype=np.int64)
            rows = np.array([row for _, row in samples], dtype=np.float64)
            if edge in self._static:
                stamps, rows = stamps[-1:], rows[-1:]
            order = np.argsort(stamps, kind="stable")
            sorted_edges[edge] = (stamps[order], rows[order])
        return sorted_edges


def describe_transforms(
    name: str, edges: Mapping[Edge, tuple[Ints, Floats]], fixed: str | None, robot: str | None
) -> TransformSource:
    """Say what the transforms of topic `name` know of the robot, between frames given or usual."""
    frames = choose_frames(edges, fixed, robot)
    if frames is None:
        return TransformSource(name, None, 0, False, f"it has no usual frames, but {known_edges(edges)}")
    try:
        chain = _chain(edges, *frames)
        samples = len(chain_poses(edges, *frames)[0])
    except LogError as broken:
        return TransformSource(name, frames, 0, False, f"{broken.what}; it has {known_edges(edges)}")
    changes = {edge: _changes(edges[edge][1]) for edge in chain}
    moving = [edge for edge in chain if changes[edge]]
    alone = bool(moving) and all("odom" in parent for parent, _ in moving)
    warning = ""
    if alone:
        warning = f"{name} moves by {' -> '.join(moving[0])} alone: odometry cannot show its own slip"
    elif len(moving) > 1 and changes[moving[0]] < _OFTEN * samples:
        warning = (
            f"{' -> '.join(moving[0])} changes {changes[moving[0]]} times in {samples} poses; "
            "between these the poses are odometry, which cannot show its own slip"
        )
    return TransformSource(name, frames, samples, alone, warning=warning)


def known_edges(edges: Mapping[Edge, object]) -> str:
    """Name the first transforms that there are."""
    shown = ", ".join(f"{a} -> {b}" for a, b in sorted(edges)[:8])
    return shown + (", ..." if len(edges) > 8 else "") or "no transforms"


def _changes(rows: Floats) -> int:
    """Count how often a transform [N, 7] differs from the one before."""
    return int((rows[1:] != rows[:-1]).any(axis=1).sum())


def choose_frames(
    edges: Mapping[Edge, object], fixed: str | None, robot: str | None
) -> tuple[str, str] | None:
    """Return the fixed frame and the robot's frame, given or usual; None if there are none."""
    names = {name for edge in edges for name in edge}
    fixed = fixed or next((name for name in _FIXED if name in names), None)
    robot = robot or next((name for name in _ROBOT if name in names), None)
    return (fixed, robot) if fixed and robot else None


def chain_poses(edges: Mapping[Edge, tuple[Ints, Floats]], fixed: str, robot: str) -> tuple[Ints, Floats]:
    """Compose the transforms from `fixed` down to `robot`.

    Of several moving transforms the one nearest to the fixed frame is the localiser's: it gives the stamps,
    and the others are interpolated there.

    Returns:
        stamps [N] in ns and (x, y, z, qx, qy, qz, qw) [N, 7].

    Raises:
        LogError: no chain connects the two frames.
    """
    chain = _chain(edges, fixed, robot)
    moving = [edge for edge in chain if len(edges[edge][0]) > 1]
    lead = moving[0] if moving else chain[0]
    stamps = edges[lead][0]
    position, rotation = np.zeros((len(stamps), 3)), np.tile([0.0, 0.0, 0.0, 1.0], (len(stamps), 1))
    covered = np.ones(len(stamps), bool)
    for edge in chain:
        edge_stamps, rows = edges[edge]
        if len(edge_stamps) > 1:
            covered &= (stamps >= edge_stamps[0]) & (stamps <= edge_stamps[-1])
        with np.errstate(invalid="ignore", over="ignore"):  # such poses are left out with those of no number
            at = _interpolate(stamps, edge_stamps, rows)
            position = position + rotate(rotation, at[:, :3])
            rotation = product(rotation, at[:, 3:])
    return stamps[covered], np.concatenate([position, rotation], axis=1)[covered]


def _chain(edges: Mapping[Edge, object], fixed: str, robot: str) -> list[Edge]:
    parent_of = {child: parent for parent, child in edges}
    chain: list[Edge] = []
    child = robot
    while child != fixed:
        parent = parent_of.get(child)
        if parent is None or len(chain) > len(edges):
            raise LogError(
                f"TF does not connect {fixed} to {robot}",
                advice=f"give --pose-frame and --child-frame; it has {known_edges(edges)}",
            )
        chain.insert(0, (parent, child))
        child = parent
    if not chain:
        raise LogError(f"the fixed frame and the robot's frame are both {fixed}", advice="give --child-frame")
    return chain


def _interpolate(stamps: Ints, at: Ints, rows: Floats) -> Floats:
    """Interpolate transforms [M, 7] at `stamps` [N]: positions linearly, rotations along the shorter way."""
    if len(at) == 1:
        return np.repeat(rows, len(stamps), axis=0)
    after = np.clip(np.searchsorted(at, stamps), 1, len(at) - 1)
    before = after - 1
    span = np.maximum(at[after] - at[before], 1)
    part = np.clip((stamps - at[before]) / span, 0.0, 1.0)[:, None]
    first, second = rows[before], rows[after].copy()
    second[:, 3:] *= np.where(np.sum(first[:, 3:] * second[:, 3:], axis=1, keepdims=True) < 0.0, -1.0, 1.0)
    mixed = (1.0 - part) * first + part * second
    norm = np.linalg.norm(mixed[:, 3:], axis=1, keepdims=True)
    exact = (part[:, 0] == 0.0) | (part[:, 0] == 1.0)
    mixed[~exact, 3:] /= np.where(norm[~exact] > 0.0, norm[~exact], 1.0)
    return np.asarray(mixed)
