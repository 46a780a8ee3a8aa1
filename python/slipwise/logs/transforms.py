# SPDX-License-Identifier: Apache-2.0
"""Poses from TF: the chain of transforms from a fixed frame to the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.findings.clocks import PostdatedPoses
from slipwise.logs.findings.finding import Finding
from slipwise.logs.header_clock import AHEAD, compare_clocks
from slipwise.logs.log import Bools, Floats, Ints
from slipwise.logs.messages import stamp_of
from slipwise.logs.rotation import product, rotate

_FIXED = ("map", "world", "mocap", "utm")
_ROBOT = ("base_link", "base_footprint")
_POSTDATED = AHEAD  # s; a correction that is stamped so much later than received is post-dated on purpose
_TOLD = 0.95  # quantile of these times: the least delayed corrections tell it best

Edge = tuple[str, str]  # parent, child


@dataclass(frozen=True, eq=False)
class Moves:
    """The transforms of one edge, in the order of their stamps."""

    stamps: Ints  # [N] ns
    rows: Floats  # [N, 7] x, y, z, qx, qy, qz, qw
    received: Ints  # [N] ns

    def select(self, keep: Bools | Ints | slice) -> Moves:
        """Return some of them."""
        return Moves(self.stamps[keep], self.rows[keep], self.received[keep])


Edges = Mapping[Edge, Moves]


@dataclass(frozen=True, eq=False)
class ChainPoses:
    """Poses of the robot from a chain of transforms."""

    stamps: Ints  # [N] ns
    received: Ints  # [N] ns
    values: Floats  # [N, 7] x, y, z, qx, qy, qz, qw
    notes: tuple[str | Finding, ...] = ()  # how they are dated, and which are used


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
        self._edges: dict[Edge, list[tuple[int, int, tuple[float, ...]]]] = {}
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
            self._edges.setdefault(edge, []).append((stamp or received_ns, received_ns, row))
            if static:
                self._static.add(edge)

    def edges(self) -> Edges:
        """Return the transforms of each edge, sorted by stamp."""
        found = {}
        for edge, moves in self.arrived().items():
            if edge in self._static:
                moves = moves.select(slice(-1, None))
            found[edge] = moves.select(np.argsort(moves.stamps, kind="stable"))
        return found

    def arrived(self) -> Edges:
        """Return the transforms of each edge in the order in which they were received."""
        return {
            edge: Moves(
                np.array([stamp for stamp, _, _ in samples], dtype=np.int64),
                np.array([row for _, _, row in samples], dtype=np.float64),
                np.array([received for _, received, _ in samples], dtype=np.int64),
            )
            for edge, samples in self._edges.items()
        }

    def part(self, keep: Mapping[Edge, Bools]) -> TransformCollector:
        """Return a collector of some transforms, in the order of `arrived`; all of an edge not named."""
        part = TransformCollector()
        part._static = self._static
        for edge, samples in self._edges.items():
            kept = keep.get(edge)
            own = samples if kept is None else [samples[i] for i in np.flatnonzero(kept).tolist()]
            if own:
                part._edges[edge] = own
        return part

    def is_static(self, edge: Edge) -> bool:
        """Say whether an edge never moves."""
        return edge in self._static


def describe_transforms(name: str, edges: Edges, fixed: str | None, robot: str | None) -> TransformSource:
    """Say what the transforms of topic `name` know of the robot, between frames given or usual."""
    frames = choose_frames(edges, fixed, robot)
    if frames is None:
        return TransformSource(name, None, 0, False, f"it has no usual frames, but {known_edges(edges)}")
    try:
        chain = _chain(edges, *frames)
        samples = len(chain_poses(edges, *frames).stamps)
    except LogError as broken:
        return TransformSource(name, frames, 0, False, f"{broken.what}; it has {known_edges(edges)}")
    moving = [edge for edge in chain if _changes(edges[edge].rows).any()]
    alone = bool(moving) and all("odom" in parent for parent, _ in moving)
    warning = ""
    if alone:
        warning = f"{name} moves by {' -> '.join(moving[0])} alone: odometry cannot show its own slip"
    return TransformSource(name, frames, samples, alone, warning=warning)


def known_edges(edges: Mapping[Edge, object]) -> str:
    """Name the first transforms that there are."""
    shown = ", ".join(f"{a} -> {b}" for a, b in sorted(edges)[:8])
    return shown + (", ..." if len(edges) > 8 else "") or "no transforms"


def _changes(rows: Floats) -> Bools:
    """Say which transforms [N, 7] differ from the one before, [N]; the first does not."""
    changed = np.zeros(len(rows), bool)
    changed[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    return changed


def choose_frames(
    edges: Mapping[Edge, object], fixed: str | None, robot: str | None
) -> tuple[str, str] | None:
    """Return the fixed frame and the robot's, given or usual; None if there are none, or of several robots.

    Frames of a robot among others have its name before them, such as tb3/base_link.
    """
    names = {name for edge in edges for name in edge}
    robot = robot or _usual(names, _ROBOT)
    if robot is None:
        return None
    above = _ancestors(edges, robot)
    fixed = fixed or _usual(above, _FIXED) or _usual(names, _FIXED)
    return (fixed, robot) if fixed else None


def _usual(names: set[str], usual: tuple[str, ...]) -> str | None:
    """Return the first frame with a usual name, else the only one with such a name after a prefix."""
    for name in usual:
        if name in names:
            return name
        prefixed = [each for each in names if each.rpartition("/")[2] == name]
        if len(prefixed) == 1:
            return prefixed[0]
    return None


def _ancestors(edges: Mapping[Edge, object], frame: str) -> set[str]:
    parent_of, found = {child: parent for parent, child in edges}, set[str]()
    while (parent := parent_of.get(frame)) is not None and parent not in found:
        found.add(parent)
        frame = parent
    return found


def chain_poses(edges: Edges, fixed: str, robot: str) -> ChainPoses:
    """Compose the transforms from `fixed` down to `robot`.

    Of several moving transforms the one nearest to the fixed frame is the localiser's: it gives the stamps,
    and the others are interpolated there. One that is stamped later than it is received was computed from
    odometry of before, by which it is dated; where it stays as it was, the pose is odometry and is left out.

    Raises:
        LogError: no chain connects the two frames.
    """
    chain = _chain(edges, fixed, robot)
    moving = [edge for edge in chain if len(edges[edge].stamps) > 1]
    lead = moving[0] if moving else chain[0]
    lower = [edge for edge in moving[1:] if _changes(edges[edge].rows).any()]
    corrections, notes = edges[lead], list[str | Finding]()
    if lower:
        corrections, notes = _dated(corrections, edges[lower[-1]], " -> ".join(lead))
    stamps = corrections.stamps
    position, rotation = np.zeros((len(stamps), 3)), np.tile([0.0, 0.0, 0.0, 1.0], (len(stamps), 1))
    covered = np.ones(len(stamps), bool)
    for edge in chain:
        own = corrections if edge == lead else edges[edge]
        if len(own.stamps) > 1:
            covered &= (stamps >= own.stamps[0]) & (stamps <= own.stamps[-1])
        with np.errstate(invalid="ignore", over="ignore"):  # such poses are left out with those of no number
            at = _interpolate(stamps, own.stamps, own.rows)
            position = position + rotate(rotation, at[:, :3])
            rotation = product(rotation, at[:, 3:])
    values = np.concatenate([position, rotation], axis=1)
    return ChainPoses(stamps[covered], corrections.received[covered], values[covered], tuple(notes))


def _dated(corrections: Moves, odometry: Moves, name: str) -> tuple[Moves, list[str | Finding]]:
    """Return the corrections dated by the odometry that they came from, without those that repeat."""
    notes: list[str | Finding] = []
    clock = compare_clocks(odometry.received / 1e9, odometry.stamps / 1e9)
    if clock is not None:
        ahead = corrections.stamps / 1e9 - clock.at(corrections.received / 1e9)
        late = float(np.quantile(ahead, _TOLD))
        if late > _POSTDATED:
            earlier = corrections.stamps - round(late * 1e9)
            corrections = Moves(earlier, corrections.rows, corrections.received)
            notes.append(PostdatedPoses.by(name, late))
    changed = _changes(corrections.rows)
    if changed.any() and not changed[1:].all():
        notes.append(
            f"{name} changes {int(changed.sum())} times in {len(changed)} transforms: between corrections "
            "the poses are the odometry, so only those at corrections are used"
        )
        corrections = corrections.select(changed)
    return corrections, notes


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
