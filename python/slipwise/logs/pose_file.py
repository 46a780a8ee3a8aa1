# SPDX-License-Identifier: Apache-2.0
"""Reads files that hold poses alone: TUM, KITTI, CSV, Parquet, GPX, NMEA, and RTKLIB (PPK)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from slipwise.addresses import shown
from slipwise.errors import LogError
from slipwise.logs.column_names import listed, place_of
from slipwise.logs.gpx import is_gpx, read_gpx
from slipwise.logs.kitti import read_kitti
from slipwise.logs.left_out import Tally
from slipwise.logs.log import OPTIONAL_POSE_COLUMNS, Floats
from slipwise.logs.nmea import is_nmea, read_nmea
from slipwise.logs.piped import LARGEST
from slipwise.logs.ppk import is_ppk, read_ppk
from slipwise.logs.remote import local_file
from slipwise.logs.rotation import angles_of, unit_quaternions
from slipwise.logs.streams import RawStream
from slipwise.logs.table import Table, read_csv, read_parquet
from slipwise.logs.vocabulary import POSE_COLUMNS

_KNOWN = (
    "give TUM (t x y z qx qy qz qw), KITTI with times.txt, a CSV or Parquet table with t, x, y, yaw, GPX, "
    "NMEA or an RTKLIB .pos file"
)
_ALIASES = {"timestamp": "t", "time": "t", "tx": "x", "ty": "y", "tz": "z"}
_QUATERNION = ("qx", "qy", "qz", "qw")
_TUM, _KITTI = 8, 12  # numbers in a line
_NANOSECONDS = 1e16  # stamps beyond this count nanoseconds, not seconds
_RECEIVERS = (("ppk", is_ppk, read_ppk), ("gpx", is_gpx, read_gpx), ("nmea", is_nmea, read_nmea))
_CALLED = {
    "tum": "a TUM pose file",
    "kitti": "a KITTI pose file",
    "gpx": "a GPX file",
    "nmea": "an NMEA file",
    "ppk": "an RTKLIB .pos file",
}
_START = 1 << 16  # bytes by which a format is known
_UNIT = 0.02  # how far a quaternion or a rotation may be from one
_BAGS = (b"\x89MCAP", b"SQLit", b"#ROSB")


@dataclass(frozen=True, eq=False)
class PoseFile:
    """The poses of a file, on its own clock; without `yaw` where it holds positions alone."""

    stream: RawStream
    format: str
    sha256: str
    notes: tuple[str, ...]

    @property
    def has_heading(self) -> bool:
        """Whether the file says how the robot was turned."""
        return "yaw" in self.stream.columns


def read_pose_file(path: Path, columns: Mapping[str, str], tally: Tally) -> PoseFile:
    """Read a file of poses by what it holds.

    Args:
        path: the file.
        columns: names that a table has, by those of a tidy log.
        tally: counts the lines that cannot be read.

    Raises:
        LogError: the file is missing, of an unknown kind or holds no poses.
    """
    file = local_file(path, "check the path after --poses", LARGEST / (1 << 20))
    path = Path(shown(path))
    if file.is_dir():
        raise LogError("a folder is not a file of poses", where=str(path), advice=_KNOWN)
    if file.stat().st_size > LARGEST:
        raise LogError(f"more than {LARGEST >> 30} GiB of poses", where=str(path), advice="thin them before")
    content = file.read_bytes()
    if content.startswith(_BAGS):
        advice = "read the bag itself with --pose-topic, or export its poses as TUM, as evo_traj does"
        raise LogError("a bag is not a file of poses", where=str(path), advice=advice)
    stream, kind, notes = _read(path, file, content, columns, tally)
    if not len(stream.t):
        raise LogError("the file holds no poses", where=str(path), advice=_KNOWN)
    stream, scaled = _in_seconds(stream)
    return PoseFile(stream, kind, hashlib.sha256(content).hexdigest(), (*notes, *scaled))


def pose_format(path: Path) -> str | None:
    """Return the format of a file that holds poses alone, by its first lines; None for anything else."""
    with path.open("rb") as file:
        start = file.read(_START)
    lines, end = start.rpartition(b"\n")[0] or start, len(start) < _START
    text = (start if end else lines).decode("utf-8-sig", errors="replace")
    kind = next((kind for kind, is_kind, _ in _RECEIVERS if is_kind(text)), None)
    if kind is not None:
        return _CALLED[kind]
    rows = [line.replace(",", " ").split() for line in _rows(text)]
    if len({len(row) for row in rows}) != 1 or len(rows[0]) not in (_TUM, _KITTI):
        return None
    try:
        values = np.array(rows, dtype=np.float64)
    except ValueError:
        return None
    if len(rows[0]) == _KITTI:
        turn = values.reshape(-1, 3, 4)[:, :, :3]
        return _CALLED["kitti"] if _are_rotations(turn) else None
    return _CALLED["tum"] if np.allclose(np.sum(values[:, 4:] ** 2, axis=1), 1.0, atol=_UNIT) else None


def refuse_poses_alone(path: Path) -> None:
    """Raise LogError where a file that is read as a log holds poses alone."""
    kind = pose_format(path)
    if kind is not None:
        raise LogError(
            f"this is {kind}: it holds poses, and no commands or wheel speeds",
            where=str(path),
            advice=f"give the log that goes with it, and this file beside it: LOG --poses {path.name}",
        )


def _rows(text: str) -> list[str]:
    """Return the lines that are neither empty nor comments."""
    return [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]


def _are_rotations(turn: Floats) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.abs(turn.transpose(0, 2, 1) @ turn - np.eye(3)).max() < _UNIT)


_Found = tuple[RawStream, str, tuple[str, ...]]  # the poses, the format, what was worked out


def _read(path: Path, file: Path, content: bytes, columns: Mapping[str, str], tally: Tally) -> _Found:
    if content.startswith(b"PAR1"):
        return _table_poses(path, read_parquet(file, columns={}), columns, tally), "parquet", ()
    if content.startswith(b"\x1f\x8b"):
        return _table_poses(path, _csv(file, tally), columns, tally), "csv.gz", ()
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise LogError("not a file of poses", where=str(path), advice=_KNOWN) from error
    for kind, is_kind, read_kind in _RECEIVERS:
        if is_kind(text):
            stream, notes = read_kind(path, text, tally)
            return stream, kind, notes
    first = next(iter(_rows(text)), "")
    count = _numbers_in(first)
    if count == _TUM:
        return _tum_poses(path, text, tally), "tum", ()
    if count == _KITTI:
        stream, notes = read_kitti(path, text)
        return stream, "kitti", notes
    return _table_poses(path, _csv(file, tally), columns, tally), "csv", ()


def _csv(file: Path, tally: Tally) -> Table:
    return read_csv(file, numeric=(), text=(), columns={}, tally=tally)


def _numbers_in(line: str) -> int:
    """Return how many numbers a line consists of, 0 where it holds anything else."""
    parts = line.replace(",", " ").split()
    try:
        return len([float(part) for part in parts])
    except ValueError:
        return 0


def _tum_poses(path: Path, text: str, tally: Tally) -> RawStream:
    rows, numbers, broken = [], [], []

    def place(line: int) -> str:
        return f"{path.name}, line {line}"

    for number, line in enumerate(text.splitlines(), start=1):
        parts = line.replace(",", " ").split()
        if not parts or parts[0].startswith("#"):
            continue
        try:
            row = [float(part) for part in parts]
        except ValueError:
            row = []
        if len(row) == _TUM:
            rows.append(row)
            numbers.append(number)
        else:
            broken.append(number)
    tally.add_lines("broken-row", "lines of poses that are not 8 numbers", broken, place)
    values = np.array(rows, dtype=np.float64).reshape(-1, _TUM)
    columns = dict(zip(("x", "y", "z"), values[:, 1:4].T, strict=True))
    found, optional = np.array(numbers, dtype=np.int64), frozenset(OPTIONAL_POSE_COLUMNS)
    stream = RawStream("poses", values[:, 0], columns, found, place, optional)
    return _turned(stream, values[:, 4:], tally)


def _table_poses(path: Path, table: Table, columns: Mapping[str, str], tally: Tally) -> RawStream:
    own = table.names
    table = replace(table, path=path, arrow=table.arrow.rename_columns(_tidy_names(own, columns)))
    names = table.names
    turned = "yaw" in names or set(_QUATERNION) <= set(names)
    missing = [name for name in ("t", "x", "y") if name not in names]
    if missing and not table.named:
        what = f"{len(own)} numbers in a line are no pose"
        raise LogError(what, where=str(path), advice=f"{_KNOWN}; or --columns t=0,x=1,y=2,yaw=3, by number")
    if missing:
        found = listed(names)
        advice = f"found {found}; say which is which, such as --columns t=time,x=east"
        raise LogError(f"missing columns: {'; '.join(missing)}", where=str(path), advice=advice)
    wanted = ("x", "y", "yaw", *OPTIONAL_POSE_COLUMNS)
    values = {name: table.numbers(name, tally) for name in wanted if name in names}
    if "frame" in names:
        values["frame"] = table.codes("frame")[0].astype(np.float64)
    t, rows = table.numbers("t", tally), np.arange(len(table))
    stream = RawStream("poses", t, values, rows, table.place, frozenset(OPTIONAL_POSE_COLUMNS))
    if "yaw" in names or not turned:
        return stream
    return _turned(stream, np.stack([table.numbers(name, tally) for name in _QUATERNION], axis=1), tally)


def _tidy_names(names: Sequence[str], columns: Mapping[str, str]) -> list[str]:
    """Return the names of a tidy log for those that were given, or that other programs use."""
    poses = {tidy: own for tidy, own in columns.items() if tidy == "t" or tidy in POSE_COLUMNS}
    given = {names[place]: tidy for tidy, own in poses.items() if (place := place_of(own, names)) is not None}
    taken = {*names, *given.values()}
    return [
        given.get(name) or (name if _ALIASES.get(name, name) in taken else _ALIASES[name]) for name in names
    ]


def _turned(stream: RawStream, quaternions: Floats, tally: Tally) -> RawStream:
    """Add the angles of quaternions [N, 4]; leave out, and count, what is no rotation."""
    q, good = unit_quaternions(quaternions)
    if not good.all():
        where = stream.place(int(stream.rows[np.argmin(good)]))
        reason = "poses whose quaternion is not a rotation"
        tally.add("bad-quaternion", reason, count=int((~good).sum()), where=where)
    angles = dict(zip(("roll", "pitch", "yaw"), angles_of(q), strict=True))
    return replace(stream, columns={**stream.columns, **angles}).select(good)


def _in_seconds(stream: RawStream) -> tuple[RawStream, tuple[str, ...]]:
    finite = stream.t[np.isfinite(stream.t)]
    if not len(finite) or float(np.median(np.abs(finite))) < _NANOSECONDS:
        return stream, ()
    return replace(stream, t=stream.t / 1e9), ("stamps of the poses are in nanoseconds",)
