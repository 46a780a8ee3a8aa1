# SPDX-License-Identifier: Apache-2.0
"""Cutting runs into segments between two measured poses as the learner does, what is rejected counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.logs.gyro import COLUMN as GYRO
from slipwise.logs.gyro import gyro_alone, gyro_rows
from slipwise.logs.held import UNKNOWN_AFTER
from slipwise.logs.log import Inputs, LeftOut, Poses, Run
from slipwise.logs.readings import READINGS, number_rows

Floats = NDArray[np.float64]

_RULES = _core.SegmentRules()
_COUNTED_BY_LOG = ("pose-outlier", "pose-jump")  # where poses have both as measured and without jumps


@dataclass(frozen=True)
class WindowRules:
    """When two poses and the inputs between them make a segment."""

    unknown_after: float = UNKNOWN_AFTER  # s; an input is unknown once it is older than this
    late_factor: float = _RULES.late_factor
    length_tolerance: float = _RULES.length_tolerance
    still_speed: float = _RULES.still_speed
    whole_frames: bool = False  # a frame that is shorter than a segment is one segment
    stride: float | None = None  # s between the starts of segments; None: each starts where the last ended
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)  # x, y [m], yaw [rad] in base_link

    def stream_settings(self, length: float, *, from_commands: bool) -> _core.StreamSettings:
        """Return the core's settings for segments of `length` [s]."""
        settings, rules = _core.StreamSettings(), _core.SegmentRules()
        rules.late_factor, rules.length_tolerance = self.late_factor, self.length_tolerance
        rules.still_speed = self.still_speed
        settings.from_commands, settings.segment_length, settings.rules = from_commands, length, rules
        settings.whole_frames, settings.stride = self.whole_frames, self.stride
        settings.unknown_after, settings.sensor = self.unknown_after, _core.Pose2(*self.sensor)
        return settings


@dataclass(frozen=True, eq=False)
class Windows:
    """Segments of several runs in order of time, [N] each."""

    run: NDArray[np.int64]  # index among the runs
    start: Floats  # s, stamp of the first pose
    end: Floats  # s, stamp of the second pose
    measured: Floats  # [N, 3] T_start_end: x, y [m], yaw [rad], heading unwrapped
    segments: tuple[_core.Segment, ...]
    histories: tuple[_core.InputHistory, ...]  # the inputs that act in each segment, or before it
    left_out: tuple[LeftOut, ...]

    def __len__(self) -> int:
        return len(self.start)


def input_rows(inputs: Inputs | None) -> Floats:
    """Return rows of (t, v, vy, omega), [N, 4]; none where there are no inputs.

    Of a car commanded by throttle and steering, v is the throttle and omega the steering.
    """
    if inputs is None:
        return np.empty((0, 4))
    if inputs.car is not None:
        return np.column_stack((inputs.t, inputs.car.throttle, inputs.vy, inputs.car.steering))
    return inputs.rows()


def recording_rows(run: Run) -> tuple[Floats, Floats, Floats, Floats]:
    """Return what was measured in a run, a row each in the order of the stamps.

    Commands and wheels as (t, v, vy, omega), attitudes as (t, roll, pitch), poses as (t, x, y, yaw, frame,
    std_xy, std_yaw), with deviations of 0 where they are not known and a yaw of NaN where only positions were
    measured.
    """
    measured = pose_rows(run.poses.as_measured)
    return input_rows(run.commands), input_rows(run.wheels), attitude_rows(run), measured


def attitude_rows(run: Run) -> Floats:
    """Return what is known of the run's attitude as (t, roll, pitch), [A, 3]."""
    poses = run.poses.as_measured
    if poses.roll is None or poses.pitch is None:
        return np.empty((0, 3))
    attitudes: Floats = np.column_stack((poses.t, poses.roll, poses.pitch))
    return attitudes[np.isfinite(attitudes).all(axis=1)]


def force_rows(run: Run) -> Floats:
    """Return known forces as rows of (t, x, y), [N, 3]."""
    forces = run.forces
    return np.empty((0, 3)) if forces is None else np.column_stack((forces.t, forces.x, forces.y))


def reading_rows(run: Run) -> dict[str, Floats]:
    """Return what is learned from sensors of one number: rows of (t, number), [N, 2], by column."""
    return {
        kind.column: gyro_rows(run) if kind.column == GYRO else number_rows(run, kind.column)
        for kind in READINGS
    }


def recording_of(
    run: Run, since: float = -np.inf, until: float = np.inf, sources: Sequence[str] = ()
) -> _core.Recording:
    """Return what was measured in a run from `since` on, and before `until` [s], as the core takes it.

    Args:
        run: what was measured.
        since: the first stamp [s].
        until: the first stamp that is not returned [s].
        sources: names of the sources of poses that the learner expects, where it tells sources or fixes
            apart; else poses are those of the run's first source.
    """
    commands, wheels, attitudes, poses = recording_rows(run)
    if sources:
        poses = sourced_rows(run, poses, sources)

    def part(rows: Floats) -> Floats:
        first, last = np.searchsorted(rows[:, 0], (since, until)).tolist()
        return rows[first:last]

    readings = {column: part(rows) for column, rows in reading_rows(run).items()}
    return _core.Recording(
        part(commands), part(wheels), part(attitudes), part(poses), readings, part(force_rows(run))
    )


def car_prior(runs: Sequence[Run], held: _core.CarCurves | None = None) -> _core.CarPrior | None:
    """Return what is taken of a car before it drives, where throttle and steering were commanded."""
    cars = (run.commands.car for run in runs if run.commands is not None)
    return next((car.prior(held) for car in cars if car is not None), None)


def wheelbase_of(runs: Sequence[Run]) -> float | None:
    """Return the wheelbase [m] of a robot that steers, where commands are to one."""
    known = (run.commands.wheelbase for run in runs if run.commands is not None)
    return next((wheelbase for wheelbase in known if wheelbase is not None), None)


def cut_windows(
    runs: Sequence[Run], settings: _core.StreamSettings, held: _core.CarCurves | None = None
) -> Windows:
    """Cut runs into segments, each as soon after the last as the poses and rules allow.

    No segment depends on a pose measured after its end, so that a log cut off at any time has the same
    segments until then. Throttle and steering go through `held` curves where these are given, otherwise
    through those that were known before each segment; the segments are the same.
    """
    settings.car = car_prior(runs, held) if settings.from_commands else None
    settings.heading_only = gyro_alone(runs)
    cut = _core.cut_segments(settings, [recording_of(run) for run in runs])
    segments = tuple(driven.segment for driven in cut.segments)
    measured = [segment.measured.vector() for segment in segments]
    return Windows(
        run=np.array(cut.run, dtype=np.int64),
        start=np.array([segment.start for segment in segments]),
        end=np.array([segment.end for segment in segments]),
        measured=np.array(measured).reshape(-1, 3),
        segments=segments,
        histories=tuple(driven.inputs for driven in cut.segments),
        left_out=rejections(runs, cut.rejected, cut.rejected_run),
    )


def rejections(
    runs: Sequence[Run], rejected: Sequence[_core.Rejected], run: Sequence[int]
) -> tuple[LeftOut, ...]:
    """Count what was rejected by reason, with the first place of each; but for what the log has counted."""
    new = [
        (each, index)
        for each, index in zip(rejected, run, strict=True)
        if each.reason not in _COUNTED_BY_LOG or runs[index].poses.measured is None
    ]
    counts = Counter(each.reason for each, _ in new)
    first: dict[str, LeftOut] = {}
    for each, index in new:
        if each.reason not in first:
            where = runs[index].place(each.t)
            first[each.reason] = LeftOut(each.reason_text, counts[each.reason], where, each.reason)
    return tuple(first[kind] for kind in sorted(first))


def source_names(runs: Iterable[Run]) -> tuple[str, ...]:
    """Return the names of the sources of poses; the first is that of the poses which predictions start from.

    An empty tuple if there is one source whose errors are all of one sort, as in most logs.
    """
    names: dict[str, None] = {}
    fixes: set[float] = set()
    first = ""
    for run in runs:
        first = first or run.source
        names |= dict.fromkeys(run.others)
        fixes |= set(_fixes(run.poses).tolist())
    return (first, *names) if names or len(fixes) > 1 else ()


def sourced_rows(run: Run, poses: Floats, sources: Sequence[str]) -> Floats:
    """Return rows of (t, x, y, yaw, frame, std_xy, std_yaw, source, fix) in the order of their stamps.

    Args:
        run: what was measured.
        poses: rows of the first source, as `recording_rows` returns them.
        sources: all names, the first source's first.
    """
    parts = [np.column_stack((poses, np.zeros(len(poses)), _fixes(run.poses.as_measured)))]
    for number, name in enumerate(sources[1:], start=1):
        if name in run.others:
            other = run.others[name]
            number_of_each = np.full(len(other), float(number))
            parts.append(np.column_stack((pose_rows(other), number_of_each, _fixes(other))))
    rows = np.concatenate(parts)
    return rows[np.argsort(rows[:, 0], kind="stable")]


def pose_rows(poses: Poses) -> Floats:
    """Return poses as rows, see `recording_rows`."""
    deviations = [
        np.zeros(len(poses)) if std is None else np.nan_to_num(std, nan=0.0)
        for std in (poses.std_xy, poses.std_yaw)
    ]
    return np.column_stack((poses.rows(), *deviations))


def _fixes(poses: Poses) -> Floats:
    return np.zeros(len(poses)) if poses.fix is None else np.nan_to_num(poses.fix)
