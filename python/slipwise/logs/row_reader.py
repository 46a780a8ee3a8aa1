# SPDX-License-Identifier: Apache-2.0
"""Reads rows of a tidy log that come one by one, by the rules by which a table of them is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from slipwise.errors import LogError
from slipwise.logs.car_commands import beyond_words
from slipwise.logs.column_names import check_columns, place_of
from slipwise.logs.corrections import late_by, turned_one
from slipwise.logs.findings.finding import Finding, Notes
from slipwise.logs.findings.wheel_layout import LayoutWatch
from slipwise.logs.fixes import FIXES, NO_FIX, fix_number
from slipwise.logs.left_out import Tally
from slipwise.logs.log import ABSURD, Floats
from slipwise.logs.measurements import Command, KnownForce, Measurement, Pose, Reading, Wheels
from slipwise.logs.options import LogOptions
from slipwise.logs.readings import READINGS
from slipwise.logs.streams import INCOMPLETE, WITHOUT_FIX, believed
from slipwise.logs.tidy import HELD_BY, UNNAMED, UNSAID, pose_columns
from slipwise.logs.tidy_columns import FORCE, InputColumns, command_columns, wheel_columns
from slipwise.logs.unheeded import LINES, refuse_unheeded
from slipwise.logs.vocabulary import BY_NAME, measured_by

HELD = "poses that repeat the one before: without a column pose_new they are held, not measured"
UNKNOWN = "columns that are none of a tidy log"


@dataclass(frozen=True)
class Row:
    """What a row says."""

    measurements: list[Measurement] = field(default_factory=list)  # at one stamp in the order of their kinds
    label: str = ""  # what the ground is said to be
    run: str | None = None  # whose row it is, where there is such a column
    left_out: list[tuple[str, str]] = field(default_factory=list)  # what cannot be used: to count, and to say
    notes: list[str] = field(default_factory=list)  # what was worked out, each once


class RowReader:
    """Reads rows in the order in which they come.

    Args:
        options: how to read them.
        further: names of columns that whoever calls reads himself.

    Raises:
        SettingsError: a column is to have another name that no column of a tidy log has, the offset of
            the poses' clock is to be found, or an option would change nothing.
    """

    def __init__(self, options: LogOptions, further: Sequence[str] = ()) -> None:
        check_columns(options.columns, tuple(BY_NAME))
        refuse_unheeded(options, LINES)
        self._options, self._late = options, late_by(options)
        self._described = frozenset() if options.wheels is None else options.wheels.names
        self._layout = None if options.wheels is None else LayoutWatch(options.wheels)
        self._further = frozenset(further)
        self._kinds: dict[tuple[str, ...], dict[str, str]] = {}  # measurement of each column, by all of them
        self._said: set[str] = set()
        self._sourced = False
        self._headed: set[str] = set()  # sources with a heading; others measure positions
        self.restart()

    def restart(self) -> None:
        """Another run begins."""
        self._wheels: dict[str, float] = {}  # the last whole readings of wheels, with their t
        self._held: dict[str, tuple[object, ...]] = {}  # the last pose of each source
        self._force = (0.0, 0.0)

    def found(self) -> tuple[Finding, ...]:
        """Return what the rows so far show to be wrong."""
        return () if self._layout is None else self._layout.found()

    def renamed(self, names: Sequence[str]) -> list[str]:
        """Return columns under their names of a tidy log."""
        given = {place_of(own, names): tidy for tidy, own in self._options.columns.items()}
        others = {name: f"_{name}" for name in given.values()}
        return [given.get(place, others.get(name, name)) for place, name in enumerate(names)]

    def read(self, cells: Mapping[str, object], names: Sequence[str]) -> Row:
        """Return what a row says.

        Args:
            cells: that are filled, by their columns.
            names: all columns of the row.

        Raises:
            LogError: there is no stamp, or it is no number.
        """
        if "t" not in cells:
            raise LogError("there is no t, the stamp in seconds")
        kinds = self._kinds_of(tuple(names))
        run = text_of(cells, "run") if "run" in names else None
        row = Row(label=text_of(cells, "terrain"), run=run)
        row.left_out.extend(self._unknown(kinds))
        view = _View(names, cells, self._wheels)
        notes: Notes = []
        for of, read in self._parts():
            if of not in kinds.values():
                continue
            try:
                row.measurements.extend(read(view, notes))
            except LogError as problem:
                row.left_out.append((f"{of}s that cannot be used", str(problem)))
        for entry in view.tally.result():
            row.left_out.append((entry.reason, entry.reason))
        for note in map(str, notes):
            if note not in self._said:
                self._said.add(note)
                row.notes.append(note)
        return row

    def _parts(self) -> tuple[tuple[str, Callable[[_View, Notes], Iterator[Measurement]]], ...]:
        return (
            ("command", self._read_command),
            ("wheel", self._read_wheels),
            ("force", self._read_force),
            ("pose", self._read_pose),
            *((kind.sensor, _reader_of(kind.column)) for kind in READINGS),
        )

    def _kinds_of(self, names: tuple[str, ...]) -> dict[str, str]:
        if names not in self._kinds:
            if len(self._kinds) > _MOST_HEADERS:
                self._kinds.clear()
            self._kinds[names] = {name: measured_by(name, self._described) for name in names}
        return self._kinds[names]

    def _unknown(self, kinds: Mapping[str, str]) -> Iterator[tuple[str, str]]:
        for name, of in kinds.items():
            if of or name in self._further or name in self._said:
                continue
            if len(self._said) > _MOST_NAMES:
                yield UNKNOWN, "ever more columns are none of a tidy log"
                continue
            self._said.add(name)
            yield UNKNOWN, f"column {name[:40]!r} is none of a tidy log and is not used"

    def _read_command(self, view: _View, notes: Notes) -> Iterator[Measurement]:
        found = command_columns(view, self._options, view.tally, notes)
        twist = self._twist(view, "commands", found, self._options.command_scale)
        if twist is not None:
            v, vy, omega = twist
            beyond = beyond_words(v, omega) if self._options.car is not None else ""
            if beyond:
                raise LogError(beyond, advice="--command-scale divides it")
            ended = found is not None and found.ended is not None and bool(found.ended[_NOW] == 1.0)
            yield Command(view.t, v, omega, vy, ended)

    def _read_wheels(self, view: _View, notes: Notes) -> Iterator[Measurement]:
        found = wheel_columns(view, self._options, view.tally, notes)
        twist = self._twist(view, "wheels", found, self._options.wheel_scale)
        if twist is not None:
            v, vy, omega = twist
            mine = (name for name in view.now if measured_by(name, self._described) == "wheel")
            self._wheels = {**{name: view.now[name] for name in mine}, "t": view.t}
            if self._layout is not None:
                self._layout.take(self._wheels, view.t)
            yield Wheels(view.t, v, omega, vy)

    def _read_force(self, view: _View, _notes: Notes) -> Iterator[Measurement]:
        said = [view.now_of(name) for name in FORCE]
        if any(map(math.isfinite, said)):
            x, y = (new if math.isfinite(new) else old for new, old in zip(said, self._force, strict=True))
            self._force = (x, y)
            yield KnownForce(view.t, x, y)

    def _read_pose(self, view: _View, notes: Notes) -> Iterator[Measurement]:
        columns = pose_columns(view, self._options, view.tally, notes)
        pose = {name: float(values[_NOW]) for name, values in columns.items()}
        if not {"x", "y"} <= set(pose):
            if pose:
                verb = "is" if len(pose) == 1 else "are"
                notes.append(f"{_WHERE}: {', '.join(pose)} {verb} used where both x and y are there")
            return
        source = text_of(view.cells, "source")
        headed = "yaw" in view.cells or not source or source in self._headed
        needed = [pose[name] for name in ("x", "y", *(["yaw"] if headed else [])) if name in pose]
        if not self._is_new(view, pose, needed):
            return
        if not all(map(math.isfinite, needed)):
            view.leave_out(f"poses {INCOMPLETE}")
            return
        fix = fix_number(text_of(view.cells, "fix"))
        if fix == NO_FIX:
            view.leave_out(f"poses {WITHOUT_FIX}")
            return
        self._sourced = self._sourced or bool(source)
        if not source and self._sourced and "source" in view.names:
            view.leave_out(UNNAMED)
            return
        if source and headed:
            self._headed.add(source)
        yield self._pose(view, pose, source, FIXES[fix])

    def _is_new(self, view: _View, pose: Mapping[str, float], needed: Sequence[float]) -> bool:
        """Whether a pose was measured in this row, rather than held, or none."""
        if "pose_new" in view.names:
            said = view.now_of("pose_new")
            if said not in (0.0, 1.0) and any(map(math.isfinite, needed)):
                view.leave_out(UNSAID)
            return said == 1.0
        if not any(map(math.isfinite, needed)):
            return False
        held = (*(repr(pose.get(name)) for name in HELD_BY), text_of(view.cells, "frame"))
        source = text_of(view.cells, "source")
        if held == self._held.get(source):
            view.leave_out(HELD)
            return False
        self._held[source] = held
        return True

    def _pose(self, view: _View, pose: Mapping[str, float], source: str, fix: str) -> Pose:
        beside = {name: float(believed(name, np.array([value]))[0]) for name, value in pose.items()}
        angles = (pose.get("yaw", math.nan), _known(beside, "roll"), _known(beside, "pitch"))
        yaw, roll, pitch = turned_one(angles, self._options.pose_yaw_offset)
        return Pose(
            view.t + self._late,
            pose["x"],
            pose["y"],
            yaw,
            _known(beside, "std_xy"),
            _known(beside, "std_yaw"),
            text_of(view.cells, "frame"),
            roll,
            pitch,
            source,
            fix,
            _known(beside, "z"),
        )

    def _twist(
        self, view: _View, name: str, found: InputColumns | None, scale: tuple[float, float]
    ) -> tuple[float, float, float] | None:
        """Return (v, vy, omega) of this row; None where it has none, which is counted where it has a part."""
        if found is None:
            return None
        said = [float(values[_NOW]) for values in found.columns().values()]
        if not any(map(math.isfinite, said)):
            return None
        if not all(map(math.isfinite, said)):
            view.leave_out(f"{name} {INCOMPLETE}")
            return None
        v, omega, vy = (*said, 0.0)[:3]
        return scale[0] * v, scale[0] * vy, scale[1] * omega


_WHERE = "lines"
_NOW = 1  # of the two rows of a view
_MOST_HEADERS = _MOST_NAMES = 1000


class _View:
    """Two rows as a table: the last whole readings of the wheels, of which rates are taken, and this row."""

    named, comment, path = True, "", Path(_WHERE)

    def __init__(
        self, names: Sequence[str], cells: Mapping[str, object], wheels: Mapping[str, float]
    ) -> None:
        self.names, self.cells, self.tally = list(names), cells, Tally()
        self._wheels = wheels
        self.now: dict[str, float] = {}  # what was read of this row
        self.t = number_of(cells, "t")

    def __len__(self) -> int:
        return 2

    def numbers(self, name: str, tally: Tally) -> Floats:
        """Return a column, NaN where the cell is empty or not finite, which is counted."""
        value = self.t if name == "t" else number_of(self.cells, name) if name in self.cells else math.nan
        if name in self.cells and not abs(value) < ABSURD:
            reason = f"cells of {name} that are not finite, or absurdly large"
            tally.add("non-finite", reason, count=1, where=_WHERE)
            value = math.nan
        self.now[name] = value
        return np.array([self._wheels.get(name, math.nan), value])

    def now_of(self, name: str) -> float:
        """Return the number of this row alone."""
        return float(self.numbers(name, self.tally)[_NOW])

    def leave_out(self, reason: str) -> None:
        """Count something of this row that is not used."""
        self.tally.add(reason, reason, count=1, where=_WHERE)


def _reader_of(column: str) -> Callable[[_View, Notes], Iterator[Measurement]]:
    def read(view: _View, _notes: Notes) -> Iterator[Measurement]:
        value = view.now_of(column)
        if math.isfinite(value):
            yield Reading(view.t, column, value)

    return read


def number_of(cells: Mapping[str, object], name: str) -> float:
    """Return a cell as a number.

    Raises:
        LogError: it is none.
    """
    try:
        return float(cells[name])  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError) as problem:
        raise LogError(f"{name} is {str(cells[name])[:40]!r}, not a number") from problem


def text_of(cells: Mapping[str, object], name: str) -> str:
    """Return a cell as text; empty where there is none."""
    return str(cells.get(name, "")).strip()


def _known(values: Mapping[str, float], name: str) -> float | None:
    value = values.get(name, math.nan)
    return value if math.isfinite(value) else None
