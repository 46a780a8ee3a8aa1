# SPDX-License-Identifier: Apache-2.0
"""Writes a log as one MCAP file with the usual ROS 2 topics, which Foxglove and `open_log` read."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipwise.errors import LogError
from slipwise.files import write_whole
from slipwise.logs.bag import FORCE_TOPIC, RUN_TOPIC, RUN_TYPE
from slipwise.logs.log import Floats, LeftOut, Log, Run, has_course
from slipwise.logs.messages import (
    ACCEL_STAMPED,
    ODOMETRY,
    POSE_STAMPED,
    POSE_WITH_COVARIANCE,
    TWIST_STAMPED,
)
from slipwise.logs.rotation import quaternions_of

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

COMMAND_TOPIC = "/cmd_vel"
WHEEL_TOPIC = "/odom"
POSE_TOPIC = "/ground_truth/pose"

_RUN_GAP_NS = 10_000_000_000  # between runs whose own times do not keep them apart
_LATEST = 2**31 - 1  # s; a header's stamp holds no later second
_IN_TWISTS = ("cmd_vx", "cmd_vy")  # columns that the twists of commands hold
_LATEST_NS = _LATEST * 1_000_000_000
_UNKNOWN_VARIANCE = 1e6  # of an odometry's unmeasured pose

Entry = tuple[int, str, bytes | memoryview]  # stamp [ns], topic, serialised message


def write_mcap(log: Log, path: Path) -> tuple[LeftOut, ...]:
    """Write the log to `path`, whole or not at all; other columns are not carried along.

    Runs are laid one after the other: a run keeps its own time if it starts after the one before has ended.

    Returns:
        what is not carried along, counted.

    Raises:
        OutputError: the file cannot be written.
        LogError: the log holds no sample at all, or one too late for a bag, or what no usual topic holds is
            all that there is.
    """
    _refuse_unwritable(log, path)
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    make = _Messages(store, log.runs)
    entries: list[Entry] = []
    end = -1
    for run in log.runs:
        start, stop = _span(run)
        shift = max(0, -start) if end < 0 else (0 if start > end else end + _RUN_GAP_NS - start)
        if stop + shift > _LATEST_NS:
            last = (stop + shift) / 1e9
            what = f"run {run.name} ends at {last:.10g} s, and stamps in a bag end at {_LATEST} s"
            raise LogError(what, where=str(path), advice="write a table (.csv, .parquet) instead")
        named = store.serialize_cdr(store.types[RUN_TYPE](data=run.name), RUN_TYPE)
        entries.append((start + shift, RUN_TOPIC, named))
        entries.extend(_run_entries(run, shift, make))
        end = stop + shift
    entries.sort(key=lambda entry: entry[0])
    write_whole(path, lambda temporary: _write(entries, temporary, make))
    return _not_written(log)


def _refuse_unwritable(log: Log, path: Path) -> None:
    if not log.runs:
        raise LogError("there is no run to write")
    what = ""
    if has_course(log.runs):  # a pose in a bag has a heading, which was not measured
        what = "positions without headings are"
    if any(run.commands is not None and run.commands.car is not None for run in log.runs):
        what = "throttle and steering are"
    if not any(len(run.poses) for run in log.runs):
        what = "turns of a gyro alone are"
    if what:
        advice = "write a table: .csv or .parquet"
        raise LogError(f"{what} not written as a bag", where=str(path), advice=advice)


def _not_written(log: Log) -> tuple[LeftOut, ...]:
    """Count what the topics do not hold."""
    counts: Counter[str] = Counter()
    for run in log.runs:
        counts["fixes of a satellite receiver"] += 0 if run.poses.fix is None else len(run.poses)
        ended = 0 if run.commands is None else int(run.commands.ends.sum())
        counts["commands that a watchdog holds or ends (--command-timeout)"] += ended
        for name, other in run.others.items():
            counts[f"poses of the source {name}"] += len(other)
        for name, values in run.extra.items():
            held = name == "t" or (run.commands is not None and name in _IN_TWISTS)
            counts[f"cells of the column {name}"] += 0 if held else _filled(values)
    return tuple(
        LeftOut(f"{what} that a bag does not hold; a table does", count, log.runs[0].name, "not-written")
        for what, count in counts.items()
        if count
    )


def _filled(values: NDArray[Any]) -> int:
    """Return how many cells hold something."""
    empty = (value is None or (isinstance(value, float) and math.isnan(value)) for value in values.tolist())
    return len(values) - sum(empty)


def _write(entries: list[Entry], temporary: Path, make: _Messages) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer

    bag = temporary.parent / "bag"  # the writer wants a folder that is not there yet
    with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        types = {
            RUN_TOPIC: RUN_TYPE,
            COMMAND_TOPIC: TWIST_STAMPED,
            WHEEL_TOPIC: ODOMETRY,
            POSE_TOPIC: make.pose_type,
            FORCE_TOPIC: ACCEL_STAMPED,
        }
        used = {topic for _, topic, _ in entries}
        connections = {
            topic: writer.add_connection(topic, kind, typestore=make.store)
            for topic, kind in types.items()
            if topic in used
        }
        for stamp, topic, data in entries:
            writer.write(connections[topic], stamp, data)
    (bag / "bag.mcap").rename(temporary)


def _span(run: Run) -> tuple[int, int]:
    """Return the first and last stamp of a run in ns."""
    streams = (run.commands, run.wheels, run.poses, run.forces)
    times = [series.t for series in streams if series is not None and len(series)]
    if not times:
        raise LogError("a run without any sample cannot be written", where=run.name)
    return _ns(min(t[0] for t in times)), _ns(max(t[-1] for t in times))


def _ns(t: float) -> int:
    return round(t * 1e9)


def _stamps(t: Floats, shift: int) -> list[int]:
    """Return stamps [N] in ns; whole seconds apart, so that nothing is lost in large numbers."""
    whole = np.floor(t)
    return list(
        (
            whole.astype(np.int64) * 1_000_000_000 + np.rint((t - whole) * 1e9).astype(np.int64) + shift
        ).tolist()
    )


def _run_entries(run: Run, shift: int, make: _Messages) -> Iterator[Entry]:
    if run.commands is not None:
        c = run.commands.sent
        rows = zip(_stamps(c.t, shift), c.v.tolist(), c.vy.tolist(), c.omega.tolist(), strict=True)
        for stamp, v, vy, omega in rows:
            yield stamp, COMMAND_TOPIC, make.command(stamp, make.twist(v, vy, omega))
    if run.wheels is not None:
        w = run.wheels
        rows = zip(_stamps(w.t, shift), w.v.tolist(), w.vy.tolist(), w.omega.tolist(), strict=True)
        for stamp, v, vy, omega in rows:
            yield stamp, WHEEL_TOPIC, make.odometry(stamp, make.twist(v, vy, omega))
    if run.forces is not None:
        f = run.forces
        for stamp, x, y in zip(_stamps(f.t, shift), f.x.tolist(), f.y.tolist(), strict=True):
            yield stamp, FORCE_TOPIC, make.force(stamp, x, y)
    p = run.poses
    zero = np.zeros(len(p))
    z, roll, pitch = (zero if column is None else np.nan_to_num(column) for column in (p.z, p.roll, p.pitch))
    variance = [zero if s is None else np.nan_to_num(s) ** 2 for s in (p.std_xy, p.std_yaw)]
    values = np.column_stack([p.x, p.y, z, quaternions_of(roll, pitch, p.yaw), *variance]).tolist()
    for stamp, frame, row in zip(_stamps(p.t, shift), p.frame.tolist(), values, strict=True):
        yield stamp, POSE_TOPIC, make.pose(stamp, "map" if frame == 0 else f"map_{frame}", row)


class _Messages:
    """Makes serialised messages; poses that do not say how sure they are have no covariance."""

    def __init__(self, store: Typestore, runs: Iterable[Run]) -> None:
        deviations = (std for run in runs for std in (run.poses.std_xy, run.poses.std_yaw))
        known = any(std is not None and np.isfinite(std).any() for std in deviations)
        self.pose_type = POSE_WITH_COVARIANCE if known else POSE_STAMPED
        self.store = store
        types: dict[str, Callable[..., Any]] = dict(store.types)
        self._header, self._time = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]
        self._vector, self._twist = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Twist"]
        self._point, self._quaternion = (
            types["geometry_msgs/msg/Point"],
            types["geometry_msgs/msg/Quaternion"],
        )
        self._pose, self._pose_covariance = (
            types["geometry_msgs/msg/Pose"],
            types["geometry_msgs/msg/PoseWithCovariance"],
        )
        self._twist_covariance = types["geometry_msgs/msg/TwistWithCovariance"]
        self._types = types
        unknown = np.zeros(36)
        unknown[[0, 7, 14, 21, 28, 35]] = _UNKNOWN_VARIANCE
        nowhere = self._pose(self._point(0.0, 0.0, 0.0), self._quaternion(0.0, 0.0, 0.0, 1.0))
        self._nowhere = self._pose_covariance(nowhere, unknown)
        self._no_covariance = np.zeros(36)

    def header(self, stamp: int, frame: str) -> Any:
        return self._header(self._time(stamp // 1_000_000_000, stamp % 1_000_000_000), frame)

    def twist(self, v: float, vy: float, omega: float) -> Any:
        return self._twist(self._vector(v, vy, 0.0), self._vector(0.0, 0.0, omega))

    def command(self, stamp: int, twist: Any) -> memoryview:
        message = self._types[TWIST_STAMPED](self.header(stamp, "base_link"), twist)
        return self.store.serialize_cdr(message, TWIST_STAMPED)

    def odometry(self, stamp: int, twist: Any) -> memoryview:
        with_covariance = self._twist_covariance(twist, self._no_covariance)
        message = self._types[ODOMETRY](
            self.header(stamp, "odom"), "base_link", self._nowhere, with_covariance
        )
        return self.store.serialize_cdr(message, ODOMETRY)

    def force(self, stamp: int, x: float, y: float) -> memoryview:
        over_mass = self._types["geometry_msgs/msg/Accel"](
            self._vector(x, y, 0.0), self._vector(0.0, 0.0, 0.0)
        )
        message = self._types[ACCEL_STAMPED](self.header(stamp, "base_link"), over_mass)
        return self.store.serialize_cdr(message, ACCEL_STAMPED)

    def pose(self, stamp: int, frame: str, row: list[float]) -> memoryview:
        x, y, z, qx, qy, qz, qw, variance_xy, variance_yaw = row
        pose = self._pose(self._point(x, y, z), self._quaternion(qx, qy, qz, qw))
        if self.pose_type == POSE_WITH_COVARIANCE:
            covariance = np.zeros(36)
            covariance[0] = covariance[7] = variance_xy
            covariance[35] = variance_yaw
            pose = self._pose_covariance(pose, covariance)
        message = self._types[self.pose_type](self.header(stamp, frame), pose)
        return self.store.serialize_cdr(message, self.pose_type)
