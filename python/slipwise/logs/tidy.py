# SPDX-License-Identifier: Apache-2.0
"""Reads tidy logs: tables with one row per stamp, see the column names in `tidy_columns`."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.logs.clock_steps import TOGETHER, Arrivals, clock_steps
from slipwise.logs.column_names import check_columns
from slipwise.logs.findings.clocks import ClockSetBack
from slipwise.logs.findings.finding import Finding, Notes
from slipwise.logs.fixes import fix_codes
from slipwise.logs.left_out import Tally
from slipwise.logs.log import (
    OPTIONAL_POSE_COLUMNS,
    Bools,
    Floats,
    Inputs,
    Ints,
    Log,
    Poses,
    Run,
    Source,
    empty_poses,
    run_name,
)
from slipwise.logs.navsat import with_course
from slipwise.logs.options import LogOptions
from slipwise.logs.pose_file import refuse_poses_alone
from slipwise.logs.streams import (
    RawStream,
    clean_stream,
    order_codes,
    to_forces,
    to_inputs,
    to_poses,
    without_fix,
)
from slipwise.logs.table import Columns, Table, is_parquet, read_table
from slipwise.logs.tidy_columns import (
    FORCE,
    MEASURED_BESIDE,
    USED,
    InputColumns,
    command_columns,
    commanded_by_direction,
    missing_input,
    require_columns,
    wheel_columns,
)
from slipwise.logs.vocabulary import BY_NAME, NUMERIC, POSE_COLUMNS, TEXT

HELD_BY = ("x", "y", "yaw", "z", "roll", "pitch")  # a row that repeats these holds the pose before
UNNAMED = "poses whose rows name no source, beside others that do"
UNSAID = "poses whose pose_new is neither 0 nor 1"


@dataclass(frozen=True, eq=False)
class _Rows:
    """The meaningful columns of a whole table, row by row."""

    t: Floats
    commands: InputColumns | None
    wheels: InputColumns | None
    pose: dict[str, Floats]
    fresh: Bools  # a pose was measured in this row
    source: tuple[Ints, tuple[str, ...]] | None  # whose poses these are: number by row, and names by number
    forces: dict[str, Floats]
    extra: dict[str, NDArray[Any]]


def read_tidy(path: Path, options: LogOptions) -> Log:
    """Read a tidy table: Parquet, or CSV compressed with gzip or not.

    Args:
        path: the file.
        options: names of columns, and the sizes of the robot where the table needs them.

    Raises:
        LogError: the file cannot be read, or columns are missing.
    """
    tally = Tally()
    return _log(load_table(path, options, tally), options, tally)


def load_table(path: Path, options: LogOptions, tally: Tally) -> Table:
    """Read a table by what its first bytes say, its columns under the names of a tidy log.

    Raises:
        LogError: the file cannot be read, holds poses alone, or has no column of a name that was given.
        SettingsError: `options.columns` names something that is not a column of a tidy log.
    """
    check_columns(options.columns, tuple(BY_NAME))
    columns = options.columns
    if options.poses is not None:  # names of pose columns are those of the other file
        columns = {tidy: own for tidy, own in columns.items() if tidy not in POSE_COLUMNS}
    if not columns and not is_parquet(path):
        refuse_poses_alone(path)
    return read_table(path, numeric=NUMERIC, text=TEXT, columns=columns, tally=tally)


def _log(table: Table, options: LogOptions, tally: Tally) -> Log:
    notes: Notes = []
    found: list[Finding] = []
    require_columns(
        table, poses=options.poses is None, described=options.wheels is not None, car=options.car is not None
    )
    if len(table) == 0:
        raise LogError("the table has no rows", where=str(table.path), advice="record the log again")
    rows = _rows(table, options, tally, notes)
    runs = tuple(
        _run(part, rows, own, table, tally)
        for name, index in _split_by_run(table)
        for part, own in _split_by_clock(name, index, rows, found)
    )
    source = Source(str(table.path), table.sha256, table.format, len(table))
    said = tuple(note for note in notes if isinstance(note, str))
    log = Log(runs, (source,), tally.result(), said, missing_input(table, rows.wheels))
    return log.with_found(*found, *(note for note in notes if isinstance(note, Finding)))


def _rows(table: Table, options: LogOptions, tally: Tally, notes: Notes) -> _Rows:
    names = table.names
    pose = pose_columns(table, options, tally, notes)
    if pose and "fix" in names:
        codes, words = table.codes("fix")
        pose["fix"] = fix_codes(words, str(table.path))[codes]
    if pose and "frame" in names:
        pose["frame"] = table.codes("frame")[0].astype(np.float64)
    pose = pose if {"x", "y"} <= set(pose) else {}
    if pose and "yaw" not in pose:
        notes.append(f"{table.path.name} has no yaw: only positions are measured")
    return _Rows(
        t=table.numbers("t", tally),
        commands=command_columns(table, options, tally, notes),
        wheels=wheel_columns(table, options, tally, notes),
        pose=pose,
        fresh=_fresh(table, pose, tally, notes) if pose else np.zeros(len(table), bool),
        source=_sources(table, notes) if pose and "source" in names else None,
        forces={name: table.numbers(name, tally) for name in FORCE if name in names},
        extra=_extra(table, notes),
    )


def pose_columns(table: Columns, options: LogOptions, tally: Tally, notes: Notes) -> dict[str, Floats]:
    """Return the numbers of poses by column; none where they come from another file."""
    if options.poses is not None:
        return {}
    pose = {
        name: table.numbers(name, tally)
        for name in ("x", "y", "yaw", *MEASURED_BESIDE)
        if name in table.names
    }
    if "yaw" in pose and "yaw_body" in table.names and commanded_by_direction(table, options):
        pose["yaw"] = table.numbers("yaw_body", tally)  # where yaw is the direction of travel
        notes.append(f"{table.path.name}: headings are yaw_body")
    return pose


def _sources(table: Table, notes: Notes) -> tuple[Ints, tuple[str, ...]] | None:
    """Return whose pose is in each row; the first source is the one that comes first in the table."""
    codes, names = _source_codes(table)
    named = np.array([bool(name) for name in names])[codes]
    if not named.any():
        return None
    order = order_codes(codes[named])
    number = np.full(len(codes), -1, dtype=np.int64)
    number[named] = order
    found = tuple(names[codes[int(np.argmax(number == i))]] for i in range(int(number.max(initial=-1)) + 1))
    if len(found) > 1:
        notes.append(f"{table.path.name}: poses are those of {found[0]}, beside them {', '.join(found[1:])}")
    return number, found


def _source_codes(table: Table) -> tuple[Ints, list[str]]:
    """Return the column of sources as codes [N] and the names, each once."""
    codes, written = table.codes("source")
    cleaned = [_source_name(name) for name in written]
    names = list(dict.fromkeys(cleaned))
    return np.array([names.index(name) for name in cleaned], np.int64)[codes], names


def _source_name(written: str) -> str:
    """Return a name without blanks around it; numbers of a column with empty cells are read as floats."""
    name = written.strip()
    return name.removesuffix(".0") if name.removesuffix(".0").isdigit() else name


def _extra(table: Table, notes: Notes) -> dict[str, NDArray[Any]]:
    """Return the columns that are carried along; notes those that cannot be read."""
    found = {}
    for name in table.names:
        if name in USED:
            continue
        try:
            found[name] = table.other(name)
        except LogError:
            notes.append(f"{table.path.name}: column {name!r} cannot be read and is not carried along")
    return found


def _fresh(table: Table, pose: dict[str, Floats], tally: Tally, notes: Notes) -> Bools:
    """Return the rows in which a pose was measured rather than held."""
    there = np.isfinite(pose["x"]) | np.isfinite(pose["y"])
    if "yaw" in pose:
        there |= np.isfinite(pose["yaw"])
    if "pose_new" in table.names:
        said = table.numbers("pose_new", tally)
        unsaid = there & (said != 0.0) & (said != 1.0)
        tally.add("unsaid", UNSAID, count=int(unsaid.sum()), where=table.place(int(np.argmax(unsaid))))
        return np.asarray(said == 1.0)
    where = np.flatnonzero(there)
    sources = _source_codes(table)[0] if "source" in table.names else np.zeros(len(table), np.int64)
    where = where[np.argsort(sources[where], kind="stable")]  # each source holds its own
    same = np.diff(sources[where]) == 0
    for name in (name for name in (*HELD_BY, "frame") if name in pose):
        values = pose[name][where]
        same &= (values[1:] == values[:-1]) | (np.isnan(values[1:]) & np.isnan(values[:-1]))
    if "run" in table.names:
        codes = table.codes("run")[0][where]
        same &= codes[1:] == codes[:-1]
    if same.any():
        notes.append(
            f"{table.path.name}: without a pose_new column, {int(same.sum())} rows that repeat the pose "
            "before are taken as held, not measured"
        )
    there[where[1:][same]] = False
    return np.asarray(there)


def _split_by_run(table: Table) -> Iterator[tuple[str, slice | Ints]]:
    """Yield each run's name and rows, in the order in which the runs appear."""
    if "run" not in table.names:
        yield run_name(table.path), slice(0, len(table))
        return
    raw, names = table.codes("run")
    codes = order_codes(raw)
    starts = np.flatnonzero(np.diff(codes, prepend=-1))
    labels = [names[raw[i]] or run_name(table.path) for i in np.unique(codes, return_index=True)[1]]
    if len(starts) == len(labels):
        for label, start, stop in zip(labels, starts, [*starts[1:], len(codes)], strict=True):
            yield label, slice(int(start), int(stop))
        return
    order = np.argsort(codes, kind="stable")
    edges = np.searchsorted(codes[order], np.arange(len(labels) + 1))
    for label, start, stop in zip(labels, edges[:-1], edges[1:], strict=True):
        yield label, order[start:stop].astype(np.int64)


def _split_by_clock(
    name: str, index: slice | Ints, rows: _Rows, found: list[Finding]
) -> Iterator[tuple[str, slice | Ints]]:
    """Yield the parts of a run before and after its clock was set back, which is found; mostly one."""
    numbers = np.arange(len(rows.t))[index]
    t = rows.t[numbers]
    if not (np.diff(t[np.isfinite(t)]) < 0.0).any():
        yield name, index
        return
    source = np.zeros(len(t), np.int64) if rows.source is None else rows.source[0][numbers]
    held = [np.isfinite(c.v[numbers]) for c in (rows.commands, rows.wheels) if c is not None]
    held += [rows.fresh[numbers] & (source == each) for each in np.unique(source).tolist() if each >= 0]
    streams = [Arrivals(np.flatnonzero(there).astype(np.float64), t[there]) for there in held if there.any()]
    usual = float(np.median(np.abs(np.diff(t[np.isfinite(t)])))) or 1.0
    steps = clock_steps(streams, together=TOGETHER / usual)
    found += [ClockSetBack.by(step.seconds, f" ({name})") for step in steps]
    edges = [0, *(int(step.order) for step in steps), len(t)]
    for number, (start, stop) in enumerate(itertools.pairwise(edges), start=1):
        yield name if number == 1 else f"{name}, part {number}", numbers[start:stop]


def _run(name: str, rows: _Rows, index: slice | Ints, table: Table, tally: Tally) -> Run:
    numbers = np.arange(index.start, index.stop) if isinstance(index, slice) else index
    t = rows.t[index]

    def stream(role: str, columns: dict[str, Floats]) -> RawStream:
        values = {key: column[index] for key, column in columns.items()}
        optional = frozenset((*OPTIONAL_POSE_COLUMNS, *FORCE, "ended"))
        return RawStream(role, t, values, numbers, table.place, optional)

    extra = {key: values[index] for key, values in rows.extra.items()}
    commands = _inputs(stream("commands", _with_ends(rows.commands)), tally) if rows.commands else None
    wheels = _inputs(stream("wheels", rows.wheels.columns()), tally) if rows.wheels else None
    forces = to_forces(_filled(stream("forces", rows.forces)), tally) if rows.forces else None
    poses, source = empty_poses(), ""
    others: dict[str, Poses] = {}
    if rows.pose:
        whole, inputs = stream("poses", rows.pose), wheels if wheels is not None else commands
        if rows.source is None:
            poses = _poses(whole.select(rows.fresh[index]), inputs, tally)
        else:
            number, names = rows.source
            unnamed = rows.fresh[index] & (number[index] < 0)
            if unnamed.any():
                place = table.place(int(numbers[np.argmax(unnamed)]))
                tally.add("no-source", UNNAMED, count=int(unnamed.sum()), where=place)
            found = _by_source(whole, np.where(rows.fresh[index], number[index], -1), len(names))
            poses, *further = (_poses(own, inputs, tally) for own in found)
            others, source = dict(zip(names[1:], further, strict=True)), names[0]
    extra = {"t": t, **extra} if extra else {}
    return Run(name, commands, wheels, poses, extra, others, source, forces=forces)


def _with_ends(commands: InputColumns) -> dict[str, Floats]:
    """Return the columns of commands, and which rows end one, where the table says so."""
    columns = commands.columns()
    return columns if commands.ended is None else {**columns, "ended": commands.ended}


def _by_source(whole: RawStream, number: Ints, count: int) -> Iterator[RawStream]:
    """Yield what each source measured, in the order of its stamps: sources may come late."""
    for i in range(count):
        yield whole.in_time(number == i)


def _poses(stream: RawStream, inputs: Inputs | None, tally: Tally) -> Poses:
    """Make poses; where no row has a yaw, positions."""
    stream = without_fix(stream, tally)
    yaw = stream.columns.get("yaw")
    if yaw is not None and len(yaw) and np.isnan(yaw).all():
        stream = replace(stream, columns={n: v for n, v in stream.columns.items() if n != "yaw"})
    if "yaw" in stream.columns:
        return to_poses(stream, tally)
    return to_poses(with_course(clean_stream(stream, tally), inputs), tally)


def _inputs(stream: RawStream, tally: Tally) -> Inputs | None:
    return to_inputs(_filled(stream), tally)


def _filled(stream: RawStream) -> RawStream:
    """Return the rows that hold any of the columns."""
    there = np.zeros(len(stream.t), bool)
    for name, values in stream.columns.items():
        there |= np.isfinite(values) & (name != "ended")
    return stream.select(there)
