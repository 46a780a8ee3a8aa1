# SPDX-License-Identifier: Apache-2.0
"""What a log is, whatever file it came from: runs of inputs and measured poses, and what was left out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.errors import LogError
from slipwise.frames import data_frame
from slipwise.logs.findings.finding import Finding

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ABSURD = 1e30  # no measurement in SI units is larger
OPTIONAL_POSE_COLUMNS = ("z", "roll", "pitch", "std_xy", "std_yaw", "fix")


@dataclass(frozen=True, eq=False)
class _Columns:
    """Columns of one length."""

    def select(self, rows: Bools | Ints | slice) -> Self:
        """Return the rows where `rows` is true, or at these places."""
        columns = {each.name: getattr(self, each.name) for each in fields(self) if each.init}
        chosen: dict[str, Any] = {}
        for name, values in columns.items():
            if isinstance(values, np.ndarray):
                chosen[name] = values[rows]
            elif isinstance(values, _Columns):
                chosen[name] = values.select(rows)
        return replace(self, **chosen)


@dataclass(frozen=True, eq=False)
class _Series(_Columns):
    """Columns over time."""

    t: Floats  # [N] s, strictly increasing

    def __len__(self) -> int:
        return len(self.t)


@dataclass(frozen=True, eq=False)
class CarCommands(_Columns):
    """Throttle and steering as they were commanded, and what is taken of a car before it drives."""

    throttle: Floats  # [N] in [-1, 1]
    steering: Floats  # [N] in [-1, 1], to the left
    top_speed: float  # m/s, at full throttle
    curvature: float  # 1/m, at full steering

    def prior(self, held: _core.CarCurves | None = None) -> _core.CarPrior:
        """Return what is taken before a car drives, as the core has it; `held` curves stay."""
        return _core.CarPrior(self.top_speed, self.curvature, held)


@dataclass(frozen=True, eq=False)
class Inputs(_Series):
    """Commands, or the body twist measured at the wheels; each sample is held until the next one.

    Raises:
        LogError: lengths differ, a value is not finite, or the stamps do not increase.
    """

    v: Floats  # [N] m/s, forward
    vy: Floats  # [N] m/s, to the left
    omega: Floats  # [N] rad/s, counter-clockwise
    car: CarCommands | None = None  # throttle and steering, where v and omega are about what they do
    wheelbase: float | None = None  # m, of commands to a robot that steers
    ended: Bools | None = None  # [N] what a watchdog holds of the command before, or zeros once it ended

    def __post_init__(self) -> None:
        _check_series(self, required=("t", "v", "vy", "omega"))

    def __repr__(self) -> str:
        return f"<Inputs: {len(self)} samples over {_duration(self.t):.1f} s>"

    @property
    def ends(self) -> Bools:
        """Which samples are a watchdog's, [N]."""
        return np.zeros(len(self), bool) if self.ended is None else self.ended

    @property
    def sent(self) -> Inputs:
        """The same without what a watchdog holds or ends, which nobody sent."""
        return self if self.ended is None else self.select(~self.ended)

    def twists(self) -> Floats:
        """Return rows of (v, vy, omega), [N, 3]."""
        return np.column_stack((self.v, self.vy, self.omega))

    def rows(self) -> Floats:
        """Return rows of (t, v, vy, omega), [N, 4]."""
        return np.column_stack((self.t, self.twists()))


@dataclass(frozen=True, eq=False)
class Poses(_Series):
    """Measured poses, only the fresh ones; the yaw is as measured, not unwrapped.

    Raises:
        LogError: lengths differ, a pose is not finite, or the stamps do not increase.
    """

    x: Floats  # [M] m
    y: Floats  # [M] m
    yaw: Floats  # [M] rad, counter-clockwise
    frame: Ints  # [M] poses are comparable only inside one frame
    z: Floats | None = None  # [M] m
    roll: Floats | None = None  # [M] rad
    pitch: Floats | None = None  # [M] rad
    std_xy: Floats | None = None  # [M] m, NaN where it is not known
    std_yaw: Floats | None = None  # [M] rad, NaN where it is not known
    fix: Floats | None = (
        None  # [M] code of what a satellite receiver says (`fixes`), NaN where it says nothing
    )
    course: bool = False  # only positions were measured: the yaw is the direction of the path
    # As measured, where outliers were rejected and frames split at jumps; poses made from these have none.
    measured: Poses | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        _check_series(self, required=("t", "x", "y", "yaw"))

    def __repr__(self) -> str:
        return f"<Poses: {len(self)} over {_duration(self.t):.1f} s>"

    @property
    def as_measured(self) -> Poses:
        """The poses before outliers were rejected and frames split at jumps."""
        return self if self.measured is None else self.measured

    def rows(self) -> Floats:
        """Return rows of (t, x, y, yaw, frame), [M, 5]; the yaw is NaN where only positions were measured."""
        yaw = np.full(len(self), np.nan) if self.course else self.yaw
        return np.column_stack((self.t, self.x, self.y, yaw, self.frame.astype(np.float64)))

    def optional(self) -> dict[str, Floats | None]:
        """Return the columns that not every log has, by name."""
        return {name: getattr(self, name) for name in OPTIONAL_POSE_COLUMNS}


@dataclass(frozen=True, eq=False)
class Forces(_Series):
    """A known force over the robot's mass; it holds until the next one.

    Raises:
        LogError: lengths differ, a value is not finite, or the stamps do not increase.
    """

    x: Floats  # [N] m/s^2, along the robot's x axis
    y: Floats  # [N] m/s^2, to its left

    def __post_init__(self) -> None:
        _check_series(self, required=("t", "x", "y"))


@dataclass(frozen=True, eq=False)
class Run:
    """One uninterrupted recording; nothing is ever joined across runs."""

    name: str
    commands: Inputs | None
    wheels: Inputs | None
    poses: Poses
    extra: Mapping[str, NDArray[Any]] = field(default_factory=dict)  # rows of a tidy log, with their "t"
    others: Mapping[str, Poses] = field(default_factory=dict)  # of further sources, by name
    source: str = ""  # name of the first source, where sources have names
    files: tuple[str, ...] = ()  # that it comes from: paths of sources of the log
    forces: Forces | None = None  # that are known to push the robot

    def __repr__(self) -> str:
        return f"<Run {self.name!r}: {', '.join(self._parts())}>"

    def _parts(self) -> list[str]:
        """What was recorded, with the number of samples."""
        counted = {"commands": self.commands, "wheel speeds": self.wheels, "poses": self.poses}
        return [f"{len(part)} {name}" for name, part in counted.items() if part is not None and len(part)]

    @property
    def span(self) -> tuple[float, float]:
        """First and last stamp of poses, commands and wheels [s], zeros where there are none."""
        times = [
            part.t for part in (self.poses, self.commands, self.wheels) if part is not None and len(part)
        ]
        if not times:
            return 0.0, 0.0
        return float(min(t[0] for t in times)), float(max(t[-1] for t in times))

    def with_each_source(self, change: Callable[[Poses], Poses]) -> Run:
        """Return the run with the poses of all sources as `change` returns them."""
        others = {name: change(poses) for name, poses in self.others.items()}
        return replace(self, poses=change(self.poses), others=others)

    def place(self, t: float) -> str:
        """Say where a time [s] is: counted from the run's start, and as it stands in the file."""
        return f"run {self.name}, {t - self.span[0]:.1f} s from its start (t = {t:.3f} s)"


@dataclass(frozen=True)
class LeftOut:
    """Something that was in the file and is not in the log."""

    reason: str
    count: int
    where: str  # the first place: file and line, row or time
    kind: str  # a short stable name, such as "duplicate-stamp"


@dataclass(frozen=True)
class Source:
    """A file that the log came from."""

    path: str
    sha256: str
    format: str
    rows: int  # rows of a table, messages of a bag


Scale = tuple[float, float]  # what the speed and the yaw rate of an input were multiplied by


@dataclass(frozen=True, eq=False)
class Log:
    """Everything read from one or several files.

    `notes` say what was guessed or worked out, `left_out` what was wrong with the data, `advice` what would
    give an input that the log could have and has not, by the input's name.
    """

    runs: tuple[Run, ...]
    sources: tuple[Source, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    notes: tuple[str, ...] = ()
    advice: Mapping[str, str] = field(default_factory=dict)
    clocks_compared: bool = False  # header stamps were compared with the times of receipt
    sideways: bool = False  # the vehicle is known to drive sideways too
    found: tuple[Finding, ...] = ()  # what its reader found to be wrong; the notes say it too
    scales: Mapping[str, Scale] = field(default_factory=dict)  # of "command" and "wheel", that were not 1

    def with_found(self, *found: Finding) -> Log:
        """Return the log with what else was found to be wrong, which is noted."""
        notes = (*self.notes, *(each.sentence for each in found))
        return replace(self, notes=notes, found=(*self.found, *found))

    def __repr__(self) -> str:
        seconds = sum(_duration(run.poses.t) for run in self.runs)
        has = {
            "commands": any(run.commands is not None for run in self.runs),
            "wheel speeds": any(run.wheels is not None for run in self.runs),
            f"{sum(len(run.poses) for run in self.runs)} poses": True,
        }
        runs = "1 run" if len(self.runs) == 1 else f"{len(self.runs)} runs"
        return f"<Log: {runs}, {seconds:.0f} s; {', '.join(name for name, there in has.items() if there)}>"

    def to_dataframe(self) -> pd.DataFrame:
        """Return the log as a pandas data frame with the columns of a tidy table, such as t, cmd_v and x.

        A row is a stamp of a run; cells are empty where the row has no such number.

        Raises:
            LogError: the log holds nothing.
            SlipwiseError: pandas is not installed.
        """
        from slipwise.logs.write_tidy import tidy_table

        table = tidy_table(self)
        return data_frame({name: table[name].to_numpy() for name in table.column_names})


def has_course(runs: Iterable[Run]) -> bool:
    """Say whether positions stand for poses, so that headings are the direction of the path."""
    return any(run.poses.course for run in runs)


def empty_poses() -> Poses:
    """Return no poses at all."""
    none = np.empty(0)
    return Poses(t=none, x=none, y=none, yaw=none, frame=np.empty(0, np.int64))


def _duration(t: Floats) -> float:
    """How long a series lasts [s]."""
    return float(t[-1] - t[0]) if len(t) else 0.0


def _check_series(series: Inputs | Poses | Forces, *, required: tuple[str, ...]) -> None:
    """Refuse a series whose columns do not fit together; the only place where this is checked."""
    name = type(series).__name__
    length = len(series.t)
    for column in (
        column
        for column in fields(series)
        if column.init and column.name not in ("course", "car", "wheelbase")
    ):
        values = getattr(series, column.name)
        if values is None:
            continue
        expected = {"frame": np.int64, "ended": np.bool_}.get(column.name, np.float64)
        if not isinstance(values, np.ndarray) or values.dtype != expected or values.ndim != 1:
            raise LogError(f"{name}.{column.name} is not a one-dimensional array of {expected.__name__}")
        if len(values) != length:
            raise LogError(f"{name}.{column.name} has {len(values)} entries where t has {length}")
        if column.name in required and not np.isfinite(values).all():
            first = int(np.argmin(np.isfinite(values)))
            raise LogError(f"{name}.{column.name} is not finite", where=f"entry {first}")
    steps = np.diff(series.t)
    if length > 1 and not (steps > 0).all():
        first = int(np.argmin(steps > 0)) + 1
        raise LogError(
            f"{name}.t does not increase", where=f"entry {first}", advice="sort and thin the samples"
        )


def run_name(path: Path) -> str:
    """Return the name of a run that has none: the file's, without its endings."""
    name = path.name
    for ending in (".gz", ".csv", ".parquet", ".mcap", ".db3", ".bag", ".bin", ".tlog", ".ulg"):
        name = name.removesuffix(ending)
    return name or "run"
