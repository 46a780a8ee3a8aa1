# SPDX-License-Identifier: Apache-2.0
"""Cutting runs into windows between two measured poses, disjoint or not, with what is left out counted."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, LeftOut, Poses, Run

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STANDARD_GRAVITY = 9.80665  # m/s^2
RECENT = 64  # intervals between poses that tell the usual one
LEAST_SHARE = 0.25  # of the length asked for; a frame shorter than this is no window


@dataclass(frozen=True)
class WindowRules:
    """When two poses and the inputs between them make a window."""

    unknown_after: float = UNKNOWN_AFTER  # s; an input is unknown once it is older than this
    late_factor: float = (
        2.5  # a pose after a gap of more than this many usual intervals is late: never an end
    )
    length_tolerance: float = 0.05  # a window may be this fraction longer or shorter than asked for
    still_speed: float = 0.02  # m/s and rad/s; a window whose inputs never exceed this teaches nothing
    whole_frames: bool = False  # a frame that is shorter than a window is one window
    stride: float | None = None  # s between the starts of windows; None: each starts where the last ended
    sensor: tuple[float, float, float] = (
        0.0,
        0.0,
        0.0,
    )  # x, y [m], yaw [rad] in base_link


_REASONS = {
    "unknown-input": "the input is unknown (older than allowed) for a stretch",
    "standing-still": "the robot was told to stand still for the whole window",
    "late-pose": "the pose comes after a gap and is late by an unknown time",
    "heading-ambiguous": "between two poses the robot may have turned by more than half a turn",
}


@dataclass(frozen=True, eq=False)
class Windows:
    """Windows of one run in order of time, [N] each."""

    start: Floats  # s, stamp of the first pose
    end: Floats  # s, stamp of the second pose
    measured: Floats  # [N, 3] T_start_end: x, y [m], yaw [rad], heading unwrapped
    gravity: Floats  # [N, 2] body-frame gravity (gx, gy) at the start [m/s^2]
    known_since: Floats  # s; the input has no gap between it and the start
    usable: Ints  # [U] indices of the poses that are not late
    left_out: tuple[LeftOut, ...]

    def __len__(self) -> int:
        return len(self.start)

    def segments(self, wheels: Inputs | None, rules: WindowRules) -> list[_core.Segment]:
        """Return the core's segments; with `wheels`, the drive is known until each starts."""
        initial = _initial_twists(self.start, wheels, rules.unknown_after)
        sensor = _core.Pose2(*rules.sensor)
        known = None if wheels is None else _core.InputTrack(wheels.t, wheels.v, wheels.vy, wheels.omega)
        return [
            _known(
                _core.Segment(start, end, _core.Pose2(x, y, yaw), twist, gx, gy).with_sensor(sensor),
                known,
                twist,
            )
            for start, end, (x, y, yaw), twist, (gx, gy) in zip(
                self.start.tolist(),
                self.end.tolist(),
                self.measured.tolist(),
                initial,
                self.gravity.tolist(),
                strict=True,
            )
        ]


def cut_windows(
    run: Run, inputs: Inputs, length: float, rules: WindowRules, *, earlier: Floats | None = None
) -> Windows:
    """Cut one run into windows of `length` [s], each as soon after the last as the poses and rules allow.

    `earlier` are the pose intervals [s] of the runs before this one. No window depends on a pose measured
    after its end, so that a log cut off at any time has the same windows until then.
    """
    cutter = _Cutter(run, inputs, length, rules)
    cutter.learn_intervals(earlier)
    for first, last in _frame_spans(run.poses.frame):
        cutter.cut(first, last)
    return cutter.windows()


class _Cutter:
    """Walks over the poses of one run and keeps pairs of pose indices."""

    def __init__(self, run: Run, inputs: Inputs, length: float, rules: WindowRules) -> None:
        self._run, self._inputs, self._length, self._rules = run, inputs, length, rules
        self._pairs: list[tuple[int, int]] = []
        self._usable: list[Ints] = []
        self._counts: Counter[str] = Counter()
        self._first: dict[str, float] = {}
        poses = run.poses
        self._yaw = np.array(poses.yaw)
        self._interval = np.zeros(len(poses))
        gaps = np.diff(inputs.t) > rules.unknown_after
        self._gap_from = np.append(inputs.t[:-1][gaps], inputs.t[-1:]) + rules.unknown_after
        self._gap_to = np.append(inputs.t[1:][gaps], np.inf)
        self._speed = np.maximum(np.hypot(inputs.v, inputs.vy), np.abs(inputs.omega))

    def learn_intervals(self, earlier: Floats | None) -> None:
        """Learn the usual time between poses, as known at each pose, from those before it."""
        within = np.diff(self._run.poses.frame) == 0
        before = np.empty(0) if earlier is None else earlier
        intervals = np.concatenate((before, pose_intervals(self._run.poses)))
        self._interval = _usual(intervals, len(before) + np.concatenate(([0], np.cumsum(within))))

    def cut(self, first: int, last: int) -> None:
        """Cut the poses first..last-1, which lie in one frame."""
        poses, rules = self._run.poses, self._rules
        self._yaw[first:last] = np.unwrap(poses.yaw[first:last])
        late = np.zeros(last - first, dtype=bool)
        late[1:] = np.diff(poses.t[first:last]) > rules.late_factor * self._interval[first : last - 1]
        for t_late in poses.t[first:last][late].tolist():
            self._leave_out("late-pose", t_late)
        usable = first + np.flatnonzero(~late)
        self._usable.append(usable)
        times = poses.t[usable]
        length = self._length
        if rules.whole_frames and LEAST_SHARE * length <= float(times[-1] - times[0]) < length:
            length = float(times[-1] - times[0])
        at = 0
        while at < len(usable) - 1:
            tolerance = max(0.5 * float(self._interval[usable[at]]), rules.length_tolerance * length)
            end = self._nearest(times, float(times[at]) + length, tolerance)
            if end <= at:
                at += 1
                continue
            problem = self._problem(int(usable[at]), int(usable[end]))
            if problem is None:
                self._pairs.append((int(usable[at]), int(usable[end])))
            else:
                self._leave_out(problem, float(times[at]))
            if problem == "unknown-input":
                at = max(at + 1, int(np.searchsorted(times, self._known_again(float(times[at])))))
            else:
                at = at + 1 if problem == "heading-ambiguous" else self._next(times, at, end)

    def _next(self, times: Floats, at: int, end: int) -> int:
        """Return the index at which the window after at..end starts."""
        if self._rules.stride is None:
            return end
        return max(at + 1, int(np.searchsorted(times, float(times[at]) + self._rules.stride - 1e-6)))

    @staticmethod
    def _nearest(times: Floats, wanted: float, tolerance: float) -> int:
        """Return the index of the time nearest to `wanted`, -1 where none is within the tolerance."""
        right = int(np.searchsorted(times, wanted))
        candidates = [i for i in (right - 1, right) if 0 <= i < len(times)]
        best = min(candidates, key=lambda i: abs(float(times[i]) - wanted))
        return best if abs(float(times[best]) - wanted) <= tolerance + 1e-9 else -1

    def _known_again(self, start: float) -> float:
        """Return when the input is known again after the gap that a window from `start` runs into."""
        if start < self._inputs.t[0]:
            return float(self._inputs.t[0])
        return float(self._gap_to[np.searchsorted(self._gap_to, start, side="right")])

    def _problem(self, i: int, j: int) -> str | None:
        """Return why poses i and j make no window, None where they do."""
        t, inputs = self._run.poses.t, self._inputs
        start, end = float(t[i]), float(t[j])
        gap = int(np.searchsorted(self._gap_to, start, side="right"))
        if start < inputs.t[0] or self._gap_from[gap] < end:
            return "unknown-input"
        held = slice(
            max(0, int(np.searchsorted(inputs.t, start, side="right")) - 1),
            int(np.searchsorted(inputs.t, end)),
        )
        if float(self._speed[held].max()) <= self._rules.still_speed:
            return "standing-still"
        fastest_turn = float(np.abs(inputs.omega[held]).max())
        if fastest_turn * float(np.diff(t[i : j + 1]).max()) > np.pi:
            return "heading-ambiguous"
        return None

    def _leave_out(self, kind: str, t: float) -> None:
        self._counts[kind] += 1
        self._first.setdefault(kind, t)

    def windows(self) -> Windows:
        poses = self._run.poses
        pairs = np.array(self._pairs, dtype=np.int64).reshape(-1, 2)
        i, j = pairs[:, 0], pairs[:, 1]
        left_out = tuple(
            LeftOut(_REASONS[kind], count, self._run.place(self._first[kind]), kind)
            for kind, count in sorted(self._counts.items())
        )
        usable = np.concatenate([np.empty(0, dtype=np.int64), *self._usable])
        return Windows(
            poses.t[i],
            poses.t[j],
            self._measured(i, j),
            _gravity(poses, i),
            self._known_since(poses.t[i]),
            usable,
            left_out,
        )

    def _known_since(self, start: Floats) -> Floats:
        """Return when the input became known that is known at each start [s], [N]."""
        known_again = np.concatenate((self._inputs.t[:1], self._gap_to[:-1]))
        return known_again[np.searchsorted(known_again, start, side="right") - 1]

    def _measured(self, i: Ints, j: Ints) -> Floats:
        """T_i_j from the measured poses, the yaw difference along the unwrapped yaw."""
        poses = self._run.poses
        dx, dy = poses.x[j] - poses.x[i], poses.y[j] - poses.y[i]
        c, s = np.cos(self._yaw[i]), np.sin(self._yaw[i])
        return np.column_stack((c * dx + s * dy, c * dy - s * dx, self._yaw[j] - self._yaw[i]))


def _frame_spans(frame: Ints) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(frame)) + 1
    bounds = [0, *edges.tolist(), len(frame)]
    return [(a, b) for a, b in itertools.pairwise(bounds) if b - a > 1]


def pose_intervals(poses: Poses) -> Floats:
    """Time between poses of one frame [s]."""
    return np.asarray(np.diff(poses.t)[np.diff(poses.frame) == 0], dtype=np.float64)


def _usual(intervals: Floats, known: Ints) -> Floats:
    """Median of the last of the first `known` intervals [s], [len(known)]; taken anew every `RECENT`.

    Where none is known yet, the first stands in; 0 where there is none at all.
    """
    if len(intervals) == 0:
        return np.zeros(len(known))
    known = np.where(known < RECENT, np.maximum(known, 1), known // RECENT * RECENT)
    counts, places = np.unique(known, return_inverse=True)
    medians = [float(np.median(intervals[max(0, n - RECENT) : n])) for n in counts.tolist()]
    return np.array(medians)[places]


def _gravity(poses: Poses, i: Ints) -> Floats:
    """Gravity along the body's x and y axes [m/s^2]; by REP-103, nose down is positive pitch."""
    if poses.roll is None or poses.pitch is None:
        return np.zeros((len(i), 2))
    roll, pitch = np.nan_to_num(poses.roll[i]), np.nan_to_num(poses.pitch[i])
    return STANDARD_GRAVITY * np.column_stack((np.sin(pitch), -np.cos(pitch) * np.sin(roll)))


def _known(
    segment: _core.Segment, drive: _core.InputTrack | None, twist: _core.BodyTwist | None
) -> _core.Segment:
    if drive is None or twist is None:
        return segment
    return segment.with_known_drive(drive, segment.start, twist)


def _initial_twists(
    start: Floats, wheels: Inputs | None, unknown_after: float
) -> list[_core.BodyTwist | None]:
    if wheels is None:
        return [None] * len(start)
    index = np.searchsorted(wheels.t, start, side="right") - 1
    fresh = (index >= 0) & (start - wheels.t[np.maximum(index, 0)] <= unknown_after)
    return [
        _core.BodyTwist(float(wheels.v[k]), float(wheels.vy[k]), float(wheels.omega[k])) if ok else None
        for k, ok in zip(index.tolist(), fresh.tolist(), strict=True)
    ]
