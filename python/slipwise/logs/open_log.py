# SPDX-License-Identifier: Apache-2.0
"""Opens logs of any kind: `open_log` looks at what a file holds and calls the reader for it."""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from slipwise.addresses import shown
from slipwise.argument_types import check_arguments
from slipwise.errors import LogError, SettingsError
from slipwise.logs.command_timeout import with_ended_commands
from slipwise.logs.corrections import scaled_inputs, turned_poses
from slipwise.logs.findings.finding import RefusedLogError
from slipwise.logs.findings.steering import NotSteered, driven_sideways
from slipwise.logs.log import Floats, Inputs, Log, Poses, Run, empty_poses, run_name
from slipwise.logs.options import LogOptions
from slipwise.logs.quality import checked
from slipwise.logs.remote import local_file
from slipwise.logs.unheeded import kind_of, refuse_unheeded

_KNOWN = (
    "give a tidy CSV, CSV.gz or Parquet file, a ROS bag (.mcap, .db3, .bag, or a rosbag2 folder), "
    "or the log of an autopilot (.bin, .tlog, .ulg)"
)

_GUESS = LogOptions()


def open_log(*paths: str | Path, options: LogOptions = _GUESS, **changes: Any) -> Log:
    """Read one or several files as one log; runs of different files are never joined.

    Args:
        paths: tidy tables (CSV, CSV.gz, Parquet), bags (rosbag1, rosbag2 folder or .db3, MCAP), and logs of
            autopilots (ArduPilot .bin and .tlog, PX4 .ulg); or addresses (https://, s3://, gs://).
        options: what slipwise cannot guess.
        changes: single fields of `LogOptions` in their place, such as start=10.0 or pose_topic="/rtk/odom".

    Raises:
        LogError: a file is missing, damaged, of an unknown kind, or says something impossible.
        SettingsError: there is no such option, its value makes no sense, or it would change nothing.
    """
    check_arguments(open_log, locals())
    if changes:
        options = _changed(options, changes)
    if not paths:
        raise LogError("no log was given", advice=_KNOWN)
    if len(paths) > 1 and options.poses is not None:
        advice = "read the logs one by one, each with its own poses"
        raise SettingsError("one file of poses goes with one log", where="--poses", advice=advice)
    logs = [_open_one(Path(path), options) for path in paths]
    refuse_unheeded(options, *(kind_of(log.sources[0]) for log in logs))
    return joined(logs)


def _changed(options: LogOptions, changes: Mapping[str, Any]) -> LogOptions:
    given = {field.name: getattr(options, field.name) for field in fields(options)}
    unknown = ", ".join(sorted(changes.keys() - given.keys()))
    if unknown:
        advice = f"it has {', '.join(given)}"
        raise SettingsError(f"no such option: {unknown}", where="open_log", advice=advice)
    return LogOptions.of({**given, **changes})


def readable(path: Path) -> tuple[Path, bool]:
    """Return the file to read, a copy of what comes through a pipe or a net, and whether it is a bag.

    Args:
        path: the file, or an address on a server.

    Raises:
        LogError: there is no such file, or it is of an unknown kind.
    """
    from slipwise.logs.bag_file import is_bag

    try:
        file = local_file(path, "check the path")
        if file.is_dir() or is_bag(file):
            return file, True
        with file.open("rb") as stream:
            start = stream.read(4)
    except PermissionError as error:
        raise LogError("no permission to read", where=shown(path), advice="check the file's owner") from error
    path = Path(shown(path))
    if path.suffix in (".yaml", ".yml"):
        advice = f"`slipwise show {path}` says what it holds"
        raise LogError("a model, not a log", where=shown(path), advice=advice)
    if not start:
        raise LogError("the file is empty", where=shown(path), advice="record or copy it again")
    if path.suffix in (".mcap", ".db3", ".bag"):
        advice = f"a {path.suffix} file starts otherwise; copy it again from the robot"
        raise LogError("not a bag: wrong magic bytes", where=shown(path), advice=advice)
    if path.suffix == ".parquet" and start != b"PAR1":
        raise LogError("not a Parquet file: wrong magic bytes", where=shown(path), advice="write it again")
    return file, False


def _open_one(path: Path, options: LogOptions) -> Log:
    file, bag = readable(path)
    with named_in_errors(path, file):
        log = _completed(_read(file, options, bag=bag), options)
        return _named(checked(log, options.unknown_after), file, path)


@contextlib.contextmanager
def named_in_errors(path: Path, file: Path) -> Iterator[None]:
    """Name the path that was given in errors, not the copy of what came through it."""
    try:
        yield
    except PermissionError as error:
        raise LogError("no permission to read", where=shown(path), advice="check the file's owner") from error
    except LogError as error:
        if file == path:
            raise
        error.where = error.where.replace(str(file), shown(path))
        raise


def _read(file: Path, options: LogOptions, *, bag: bool) -> Log:
    """Call the reader for the file; the readers are loaded only when they are needed."""
    if bag:
        from slipwise.logs.bag import read_bag

        return read_bag(file, options)
    from slipwise.logs.flight_log import flight_format, read_flight_log

    if flight_format(file) is not None:
        return read_flight_log(file, options)
    from slipwise.logs.tidy import read_tidy

    return read_tidy(file, options)


def _completed(log: Log, options: LogOptions) -> Log:
    """Scale inputs, take poses of a file beside the log, turn them, cut the log: what is asked for."""
    log = scaled_inputs(log, options)
    if options.poses is not None:
        from slipwise.logs.poses_beside import with_other_poses, with_poses

        log = with_poses(log, options.poses, options)
        for path in options.other_poses:
            log = with_other_poses(log, path, options)
    elif options.pose_clock_offset is not None:
        from slipwise.logs.poses_beside import with_shifted_poses

        log = with_shifted_poses(log, options)
    log = cut_to_span(turned_poses(log, options), options.start, options.end)
    log = replace(log, sideways=options.sideways) if options.sideways else log
    log = with_ended_commands(log, options.command_timeout, options.unknown_after)
    if options.car is None:
        return log if options.wheelbase is None else _steered(log, options.wheelbase)
    from slipwise.logs.car_commands import with_car_commands

    return with_car_commands(log, options)


def _steered(log: Log, wheelbase: float) -> Log:
    """Say of all commands that they are to a robot that steers.

    Raises:
        LogError: they drive it sideways.
    """
    if driven_sideways(log.runs):
        raise RefusedLogError(NotSteered.of_sideways(), log.sources[0].path)
    runs = tuple(
        run if run.commands is None else replace(run, commands=replace(run.commands, wheelbase=wheelbase))
        for run in log.runs
    )
    return replace(log, runs=runs)


def _named(log: Log, file: Path, path: Path) -> Log:
    """Name the path that was given, not the copy of what came through it; each run knows its files."""
    if file != path:
        log = replace(log, sources=tuple(replace(source, path=shown(path)) for source in log.sources))
    files = tuple(source.path for source in log.sources)
    return replace(log, runs=tuple(replace(run, files=files) for run in log.runs))


def _with_first(first: str, run: Run) -> Run:
    """Return a run whose first source of poses is that of all logs; without poses where it lacks that one."""
    if run.source in ("", first):
        return run
    others = {name: poses for name, poses in run.others.items() if name != first}
    poses = run.others.get(first, empty_poses())
    return replace(run, poses=poses, others={run.source: run.poses, **others}, source=first)


def joined(logs: list[Log]) -> Log:
    """Return several logs as one; runs of the same name get that of their file, their first source is one."""
    if len(logs) == 1:
        return logs[0]
    first = next((run.source for log in logs for run in log.runs if run.source), "")
    names = Counter(name for log in logs for name in {run.name for run in log.runs})
    return Log(
        runs=tuple(
            _with_first(first, replace(run, name=f"{label}/{run.name}") if names[run.name] > 1 else run)
            for label, log in zip(_labels(logs), logs, strict=True)
            for run in log.runs
        ),
        sources=tuple(source for log in logs for source in log.sources),
        left_out=tuple(entry for log in logs for entry in log.left_out),
        notes=tuple(note for log in logs for note in log.notes),
        advice={name: text for log in reversed(logs) for name, text in log.advice.items()},
        clocks_compared=all(log.clocks_compared for log in logs),
        sideways=any(log.sideways for log in logs),
        found=tuple(each for log in logs for each in log.found),
        scales={kind: scale for log in reversed(logs) for kind, scale in log.scales.items()},
    )


def _labels(logs: list[Log]) -> list[str]:
    """Return a name for each file; the file's own, numbered where it occurs twice."""
    stems = [run_name(Path(log.sources[0].path)) if log.sources else "log" for log in logs]
    counted = Counter(stems)
    return [stem if counted[stem] == 1 else f"{number}-{stem}" for number, stem in enumerate(stems, start=1)]


def cut_to_span(log: Log, start: float | None, end: float | None) -> Log:
    """Return what lies between `start` and `end` [s], counted from the first stamp of the log.

    The input that is held at the start stays. Where runs begin their clocks again, each is cut so.

    Raises:
        LogError: nothing is left.
    """
    stamps = [t for run in log.runs for t in _stamps(run) if len(t)]
    if (start is None and end is None) or not stamps:
        return log
    first, last = min(float(t[0]) for t in stamps), max(float(t[-1]) for t in stamps)
    low, high = first + (start or 0.0), first + (math.inf if end is None else end)
    runs = tuple(run for run in (_cut_run(run, low, high) for run in log.runs) if len(run.poses))
    until = "its end" if end is None else f"{end:g} s"
    span = f"{start or 0.0:g} s to {until}"
    if not runs:
        where = log.sources[0].path if log.sources else ""
        given = " ".join(f"--{n} {v:g}" for n, v in (("start", start), ("end", end)) if v is not None)
        what = f"the log is {last - first:.0f} s long; {given} leaves no pose"
        raise LogError(what, where=where, advice="choose times within the log")
    return replace(log, runs=runs, notes=(*log.notes, f"only {span} of {last - first:.1f} s are used"))


def _stamps(run: Run) -> tuple[Floats, ...]:
    inputs = [series.t for series in (run.commands, run.wheels) if series is not None]
    return (run.poses.t, *inputs)


def _cut_run(run: Run, low: float, high: float) -> Run:
    def inside(poses: Poses) -> Poses:
        return poses.select((poses.t >= low) & (poses.t <= high))

    extra = {}
    if run.extra:
        t = np.asarray(run.extra["t"], dtype=np.float64)
        extra = {name: values[(t >= low) & (t <= high)] for name, values in run.extra.items()}
    forces = run.forces
    return replace(
        run,
        commands=_cut(run.commands, low, high),
        wheels=_cut(run.wheels, low, high),
        poses=inside(run.poses),
        extra=extra,
        others={name: inside(other) for name, other in run.others.items()},
        forces=None if forces is None else forces.select(_held_part(forces.t, low, high)),
    )


def _cut(inputs: Inputs | None, low: float, high: float) -> Inputs | None:
    cut = None if inputs is None else inputs.select(_held_part(inputs.t, low, high))
    return cut or None


def _held_part(t: Floats, low: float, high: float) -> slice:
    """Return which samples lie in a span, with the one before, which still holds."""
    held = max(int(np.searchsorted(t, low, side="right")) - 1, 0)
    return slice(held, int(np.searchsorted(t, high, side="right")))
