# SPDX-License-Identifier: Apache-2.0
"""Puts the poses of a file into a log that holds inputs, on the clock of the log."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np

from slipwise.addresses import shown
from slipwise.errors import LogError
from slipwise.logs.left_out import Tally
from slipwise.logs.log import Inputs, Log, Run, Source, empty_poses, has_course
from slipwise.logs.navsat import with_course
from slipwise.logs.options import AUTO, LogOptions
from slipwise.logs.pose_clock import agreement_at, find_clock_offset, pose_motion
from slipwise.logs.pose_file import read_pose_file
from slipwise.logs.streams import RawStream, clean_stream, to_poses

_LOW_AGREEMENT = 0.3  # agreement of motions below which clocks may be apart
_BESIDE = 1.0  # [s] before the first and after the last input, poses are still taken


def with_poses(log: Log, path: Path, options: LogOptions) -> Log:
    """Return the log with the poses of the file, shifted by the offset that is given or found.

    Raises:
        LogError: the file cannot be read, does not overlap with the log, or the offset cannot be found.
    """
    tally = Tally()
    file = read_pose_file(path, options.columns, tally)
    path = Path(shown(path))
    spans = _spans(log, path)
    poses = clean_stream(file.stream, tally)
    if not len(poses.t):
        raise LogError("the file holds no usable poses", where=shown(path), advice="see how it was written")
    offset, found = _offset(log, poses, path, options)
    poses = replace(poses, t=poses.t + offset)
    runs = []
    for run, (first, last) in zip(log.runs, spans, strict=True):
        inside = poses.select((poses.t >= first - _BESIDE) & (poses.t <= last + _BESIDE))
        runs.append(_with_stream(run, inside, tally, headed=file.has_heading))
    used = sum(len(run.poses) for run in runs)
    if used == 0:
        raise LogError(_apart(poses, spans), where=shown(path), advice=_CLOCKS)
    note = f"poses are those of {path.name} ({file.format}): {used} of {len(poses.t)} lie in the log"
    source = Source(shown(path), file.sha256, file.format, len(file.stream.t))
    return replace(
        log,
        runs=tuple(runs),
        sources=(*log.sources, source),
        left_out=log.left_out + tally.result(),
        notes=(*log.notes, note, *file.notes, *found),
    )


def with_other_poses(log: Log, path: Path, options: LogOptions) -> Log:
    """Return the log with the poses of a further file as a source beside its own, named by the file's stem.

    An offset that is given is that of all files; where `pose_clock_offset` is "auto", each has its own.

    Raises:
        LogError: the file cannot be read, does not overlap with the log, or the offset cannot be found.
    """
    beside = with_poses(log, path, options)
    first = "" if options.poses is None else options.poses.stem
    runs = tuple(
        replace(run, others={**run.others, path.stem: other.poses}, source=run.source or first)
        for run, other in zip(log.runs, beside.runs, strict=True)
    )
    return replace(beside, runs=runs)


def with_shifted_poses(log: Log, options: LogOptions) -> Log:
    """Return the log with its own poses on the clock of its inputs, by the offset that is given or found.

    Poses of further sources are shifted as those of the first: how late they are beside it stays.

    Raises:
        LogError: the offset cannot be found.
    """
    if options.pose_clock_offset is None:
        return log
    usable = [run for run in log.runs if len(run.poses)]
    apart = all(a.poses.t[-1] < b.poses.t[0] for a, b in itertools.pairwise(usable))
    if options.pose_clock_offset == AUTO and not (usable and apart):
        what = "several runs of the log have the same times, so no offset of clocks can be found"
        raise LogError(
            what, where=_first_path(log), advice="give the seconds to add with --pose-clock-offset"
        )
    t, x, y, yaw = (
        np.concatenate([getattr(run.poses, name) for run in usable]) for name in ("t", "x", "y", "yaw")
    )
    columns = {"x": x, "y": y} | ({} if has_course(usable) else {"yaw": yaw})
    stream = RawStream("poses", t, columns, np.arange(len(t)), str)
    offset, said = _offset(log, stream, Path("its poses"), options)
    shifted = tuple(run.with_each_source(lambda own: replace(own, t=own.t + offset)) for run in log.runs)
    return replace(log, runs=shifted, notes=(*log.notes, *said))


def _first_path(log: Log) -> str:
    return log.sources[0].path if log.sources else ""


_CLOCKS = "give --pose-clock-offset auto to find the offset of their clocks, or the seconds to add"


def _offset(log: Log, poses: RawStream, path: Path, options: LogOptions) -> tuple[float, tuple[str, ...]]:
    """Return the seconds to add to the stamps, and how they were found or how well they fit."""
    wheels = any(run.wheels is not None for run in log.runs)
    inputs = [series for run in log.runs if (series := run.wheels if wheels else run.commands) is not None]
    heading = poses.columns.get("yaw", np.full(len(poses.t), np.nan))
    motion = pose_motion(poses.t, poses.columns["x"], poses.columns["y"], heading)
    given = options.pose_clock_offset
    if given != AUTO:
        offset = float(given or 0.0)
        return offset, _words_of_given(
            offset, path, agreement_at(inputs, motion, offset, options.unknown_after)
        )
    if not len(motion.start):
        advice = "give the seconds to add with --pose-clock-offset"
        raise LogError("too few poses to find an offset of clocks", where=shown(path), advice=advice)
    try:
        match = find_clock_offset(inputs, motion, options.unknown_after, lagging=not wheels)
    except LogError as unclear:
        raise LogError(unclear.what, where=shown(path), advice=unclear.advice) from unclear
    note = (
        f"{match.offset:+.3f} s are added to the stamps of {path.name}: its motion then agrees best with "
        f"the {'wheels' if wheels else 'commands'} ({match.agreement:.2f}, next best {match.next_best:.2f})"
    )
    delay = "the delay of the drive is a part of that offset, since commands alone show both together"
    return match.offset, (note,) if wheels else (note, delay)


def _words_of_given(offset: float, path: Path, agreement: float) -> tuple[str, ...]:
    notes = [f"{offset:+g} s are added to the stamps of {path.name}"] if offset else []
    if -1.0 < agreement < _LOW_AGREEMENT:
        notes.append(
            f"the motion of {path.name} hardly agrees with the inputs ({agreement:.2f} of 1): if its "
            "clock is another, give --pose-clock-offset auto"
        )
    return tuple(notes)


def _spans(log: Log, path: Path) -> list[tuple[float, float]]:
    """Return the first and the last input of each run.

    Raises:
        LogError: there are no inputs, or runs overlap, so that a pose may belong to several.
    """
    spans = [_span(run) for run in log.runs]
    if all(first > last for first, last in spans):
        raise LogError(
            "the log has no usable inputs", where=_first_path(log), advice="see `slipwise inspect`"
        )
    known = sorted(span for span in spans if span[0] <= span[1])
    for (_, earlier), (later, _) in itertools.pairwise(known):
        if later < earlier:
            raise LogError(
                "several runs of the log have the same times, so it is not clear whose the poses are",
                where=shown(path),
                advice="give a log with one run",
            )
    return spans


def _span(run: Run) -> tuple[float, float]:
    stamps = [series.t for series in (run.commands, run.wheels) if series is not None and len(series)]
    if not stamps:
        return np.inf, -np.inf
    return min(float(t[0]) for t in stamps), max(float(t[-1]) for t in stamps)


def _with_stream(run: Run, stream: RawStream, tally: Tally, *, headed: bool) -> Run:
    if not len(stream.t):
        return replace(run, poses=empty_poses())
    if headed:
        return replace(run, poses=to_poses(stream, tally))
    inputs: Inputs | None = run.wheels if run.wheels is not None else run.commands
    return replace(run, poses=to_poses(with_course(stream, inputs), tally))


def _apart(poses: RawStream, spans: list[tuple[float, float]]) -> str:
    first, last = min(span[0] for span in spans), max(span[1] for span in spans)
    return (
        f"no pose lies within the log: poses are from {poses.t[0]:.1f} s to {poses.t[-1]:.1f} s, "
        f"the log from {first:.1f} s to {last:.1f} s"
    )
