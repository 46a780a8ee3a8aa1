# SPDX-License-Identifier: Apache-2.0
"""Cutting holds into path segments that are moved to the origin (thesis 4.1)."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import SettingsError
from slipwise.logs.log import Inputs, LeftOut, Poses, Run
from slipwise_thesis import _thesis
from slipwise_thesis.steady.holds import Hold, HoldRules, find_holds

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PathRules:
    """How holds become path segments."""

    length: float = 3.0  # s
    least_distance: float = (
        2.0  # m; segments of slow holds are longer than `length`, as far as the hold lasts
    )
    settle: float = 1.0  # s after a change of command that are left out: lag is not slip
    stride: float | None = None  # s from start to start; None: each begins where the last ended
    longest_gap: float = 0.5  # s between two poses of a segment
    hold: HoldRules = field(default_factory=HoldRules)


@dataclass(frozen=True, eq=False)
class SteadyPath:
    """Measured poses under one held command, seen from the first of them."""

    run: str
    start: float  # s, stamp of the first pose
    command: tuple[float, float, float]  # v, vy [m/s], omega [rad/s]
    times: Floats  # [N] s since the first pose; the first is 0
    poses: Floats  # [N, 3] x, y [m], yaw [rad, unwrapped]; the first is the origin
    overlap: float = 1.0  # how many segments share each datum

    @property
    def distance(self) -> float:
        """Commanded distance [m]."""
        return float(np.hypot(*self.command[:2]) * self.times[-1])

    def core(self) -> _thesis.SteadySegment:
        """Return the core's segment."""
        return _thesis.SteadySegment(_core.BodyTwist(*self.command), self.times, self.poses)


@dataclass(frozen=True, eq=False)
class SteadyPaths:
    """The path segments of one run, and what gave none."""

    paths: tuple[SteadyPath, ...]
    left_out: tuple[LeftOut, ...]


_REASONS = {
    "short-hold": "the command was not held, or poses are missing, for as long as a segment needs",
    "pose-gap": "poses of the segment lie too far apart",
    "heading-ambiguous": "between two poses the robot may have turned by more than half a turn",
    "short-distance": "the hold ended before the least distance was driven; the segment is kept",
}


def cut_paths(run: Run, inputs: Inputs, rules: PathRules = PathRules()) -> SteadyPaths:
    """Cut the holds of `inputs` in one run into path segments.

    Raises:
        SettingsError: a length, stride or time makes no sense.
    """
    _check(rules)
    cutter = _Cutter(run, rules)
    for hold in find_holds(inputs, rules.hold):
        cutter.cut(hold)
    where = f"run {run.name}, t = "
    left_out = tuple(
        LeftOut(_REASONS[kind], count, f"{where}{cutter.first[kind]:.3f} s", kind)
        for kind, count in sorted(cutter.counts.items())
    )
    return SteadyPaths(tuple(cutter.paths), left_out)


def _check(rules: PathRules) -> None:
    positive = {"length": rules.length, "longest_gap": rules.longest_gap}
    if rules.stride is not None:
        positive["stride"] = rules.stride
    for name, value in positive.items():
        if not (np.isfinite(value) and value > 0):
            raise SettingsError(f"{name} is {value}", where=name, advice="give a positive number of seconds")
    held = {f"hold.{field.name}": getattr(rules.hold, field.name) for field in fields(rules.hold)}
    for name, value in ({"settle": rules.settle, "least_distance": rules.least_distance} | held).items():
        if not (np.isfinite(value) and value >= 0):
            raise SettingsError(f"{name} is {value}", where=name, advice="give zero or a positive number")


class _Cutter:
    """Gathers the segments of one run."""

    def __init__(self, run: Run, rules: PathRules) -> None:
        self._run, self._rules = run, rules
        self.paths: list[SteadyPath] = []
        self.counts: Counter[str] = Counter()
        self.first: dict[str, float] = {}

    def cut(self, hold: Hold) -> None:
        """Cut one hold, each part of it that lies in one frame."""
        poses, rules = self._run.poses, self._rules
        first = int(np.searchsorted(poses.t, hold.start + rules.settle - 1e-9))
        after = int(np.searchsorted(poses.t, hold.end + 1e-9, side="right"))
        found = len(self.paths)
        edges = first + 1 + np.flatnonzero(np.diff(poses.frame[first:after]))
        for part in np.split(np.arange(first, max(first, after)), edges - first):
            if len(part):
                self._cut_part(hold, part)
        if len(self.paths) == found:
            self._leave_out("short-hold", hold.start)

    def _cut_part(self, hold: Hold, part: NDArray[np.int64]) -> None:
        """Cut consecutive poses of one frame."""
        t = self._run.poses.t[part]
        speed = float(np.hypot(hold.v, hold.vy))
        length, tolerance = self._length(speed, float(t[-1] - t[0])), 0.05 * self._rules.length
        at = 0
        while t[-1] - t[at] >= length - tolerance:
            end = int(np.argmin(np.abs(t - (t[at] + length))))
            if end <= at + 1:
                break
            self._add(hold, part[at : end + 1], length)
            stride = self._rules.stride
            at = end if stride is None else max(at + 1, int(np.searchsorted(t, t[at] + stride - 1e-9)))
            if at >= len(t):
                break

    def _length(self, speed: float, available: float) -> float:
        """Long enough for the least distance where the hold allows it, but never shorter than asked for."""
        wanted = self._rules.least_distance / speed if speed > 1e-9 else 0.0
        if wanted * speed > 0 and speed <= self._rules.hold.still_speed:
            wanted = 0.0  # turning in place has no distance to drive
        return max(self._rules.length, min(wanted, available))

    def _add(self, hold: Hold, part: NDArray[np.int64], length: float) -> None:
        poses = self._run.poses
        t = poses.t[part]
        longest = float(np.diff(t).max())
        if longest > self._rules.longest_gap:
            return self._leave_out("pose-gap", float(t[0]))
        if abs(hold.omega) * longest > np.pi:
            return self._leave_out("heading-ambiguous", float(t[0]))
        stride = self._rules.stride
        path = SteadyPath(
            run=self._run.name,
            start=float(t[0]),
            command=(hold.v, hold.vy, hold.omega),
            times=t - t[0],
            poses=_from_first(poses, part),
            overlap=1.0 if stride is None else max(1.0, length / stride),
        )
        self.paths.append(path)
        speed = float(np.hypot(hold.v, hold.vy))
        if speed > self._rules.hold.still_speed and path.distance < 0.95 * self._rules.least_distance:
            self._leave_out("short-distance", float(t[0]))
        return None

    def _leave_out(self, kind: str, t: float) -> None:
        self.counts[kind] += 1
        self.first.setdefault(kind, t)


def _from_first(poses: Poses, part: NDArray[np.int64]) -> Floats:
    """Return the poses [N, 3] as seen from the first, the yaw followed from pose to pose."""
    dx, dy = poses.x[part] - poses.x[part[0]], poses.y[part] - poses.y[part[0]]
    yaw = np.unwrap(poses.yaw[part])
    c, s = np.cos(yaw[0]), np.sin(yaw[0])
    return np.column_stack((c * dx + s * dy, c * dy - s * dx, yaw - yaw[0]))
