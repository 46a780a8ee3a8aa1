# SPDX-License-Identifier: Apache-2.0
"""Small sound files of every kind that slipwise reads; fuzzing starts from them."""

from __future__ import annotations

import functools
import gzip
import importlib.util
import io
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

# What the tests write autopilots' and Foxglove's logs with, by the libraries of these formats.
sys.path.append(str(Path(__file__).resolve().parents[1] / "python" / "tests"))

SECOND = 1_000_000_000
EPOCH = 1_700_000_000 * SECOND
ROWS = 30  # of a table, or of each topic of a bag

_MAP = "image: map.pgm\nresolution: 0.5\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\nfree_thresh: 0.196\n"
_SETTINGS = (
    'basis = "edd-2"\nlearn_clock_offset = true\n'
    "[segment]\nlength = 1.0\nunknown_after = 0.4\n[prior]\ntime_constant = 0.3\n"
    "delay = 0.2\n[noise]\npsd_motion = [0.001, 0.001, 0.001]\npose_std_xy = 0.02\n[filter]\nhuber = 2.0\n"
)


def seeds(target: str) -> list[bytes]:
    """Return the files that fuzzing of a target starts from."""
    return [make() for make in _SEEDS[target]]


def _table() -> dict[str, np.ndarray]:
    t = np.round(np.arange(ROWS) * 0.1, 3)
    zero = np.zeros(ROWS)
    columns = {"t": t, "cmd_v": zero + 1.0, "cmd_omega": zero, "odo_v": zero + 1.0, "odo_omega": zero}
    return columns | {"x": t, "y": zero, "yaw": zero, "std_xy": zero + 0.01, "pose_new": zero + 1.0}


def _csv() -> bytes:
    columns = _table()
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    lines = ["run," + ",".join(columns), *("one," + ",".join(map(str, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def _parquet(compression: str) -> bytes:
    sink = pa.BufferOutputStream()
    pq.write_table(pa.table({"run": ["one"] * ROWS} | _table()), sink, compression=compression)
    return bytes(sink.getvalue().to_pybytes())


def _messages(ros1: bool) -> tuple[Any, list[tuple[int, str, str, bytes]]]:
    """Commands, wheel odometry and poses of a straight drive, serialised."""
    store: Any = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    types, found = store.types, []
    serialise = store.serialize_ros1 if ros1 else store.serialize_cdr

    def header(stamp: int, frame: str) -> Any:
        time = types["builtin_interfaces/msg/Time"](stamp // SECOND, stamp % SECOND)
        return types["std_msgs/msg/Header"](*([0] if ros1 else []), time, frame)

    def vector(x: float, z: float = 0.0) -> Any:
        return types["geometry_msgs/msg/Vector3"](x, 0.0, z)

    for k in range(ROWS):
        stamp = EPOCH + k * SECOND // 10
        twist = types["geometry_msgs/msg/Twist"](vector(1.0), vector(0.0))
        position = types["geometry_msgs/msg/Point"](0.1 * k, 0.0, 0.0)
        upright = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
        pose = types["geometry_msgs/msg/Pose"](position, upright)
        covariance = np.zeros(36)
        placed = types["geometry_msgs/msg/PoseWithCovariance"](pose, covariance)
        moving = types["geometry_msgs/msg/TwistWithCovariance"](twist, covariance)
        made = (
            ("/cmd_vel", "geometry_msgs/msg/TwistStamped", (header(stamp, "base_link"), twist)),
            ("/odom", "nav_msgs/msg/Odometry", (header(stamp, "odom"), "base_link", placed, moving)),
            ("/rtk/pose", "geometry_msgs/msg/PoseWithCovarianceStamped", (header(stamp, "map"), placed)),
        )
        for topic, kind, fields in made:
            found.append((stamp, topic, kind, bytes(serialise(types[kind](*fields), kind))))
    return store, found


def _write(writer: Any, ros1: bool) -> None:
    store, messages = _messages(ros1)
    with writer:
        connections: dict[str, Any] = {}
        for stamp, topic, kind, data in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], stamp, data)


def _bag2(plugin: StoragePlugin, *, packed: bool = False) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        writer = Writer2(bag, version=9, storage_plugin=plugin)
        if packed:
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        _write(writer, ros1=False)
        return next(path for path in bag.iterdir() if path.suffix in (".mcap", ".db3")).read_bytes()


def _bag1(compression: Any) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        writer = Writer1(Path(folder) / "a.bag")
        if compression is not None:
            writer.set_compression(compression)
        _write(writer, ros1=True)
        return (Path(folder) / "a.bag").read_bytes()


def _drive() -> bytes:
    t = np.round(np.arange(0.0, 40.0, 0.1), 3)
    v, omega = 0.5 + 0.5 * np.sin(t / 3.0), 0.5 * np.sin(t / 2.0)
    yaw = np.cumsum(0.7 * omega * 0.1)
    x, y = np.cumsum(0.95 * v * np.cos(yaw) * 0.1), np.cumsum(0.95 * v * np.sin(yaw) * 0.1)
    text = io.StringIO()
    columns = np.column_stack([t, v, omega, x, y, yaw])
    np.savetxt(text, columns, "%.6g", ",", header="t,cmd_v,cmd_omega,x,y,yaw", comments="")
    return text.getvalue().encode()


def _model() -> bytes:
    from slipwise.calibration import calibrate, make_settings
    from slipwise.logs import open_log

    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "drive.csv"
        table.write_bytes(_drive())
        model = calibrate(open_log(table), settings=make_settings({"basis": "edd-2"})).model
        model.save(Path(folder) / "model.yaml")
        return (Path(folder) / "model.yaml").read_bytes()


def _flight(kind: str) -> bytes:
    import sample_flights

    with tempfile.TemporaryDirectory() as folder:
        write = getattr(sample_flights, f"write_{kind}")
        written: Path = write(Path(folder) / "drive", sample_flights.made_flight(1.2, 20.0))
        return written.read_bytes()


def _foxglove(kind: str) -> bytes:
    import sample_foxglove

    with tempfile.TemporaryDirectory() as folder:
        return sample_foxglove.WRITERS[kind](Path(folder) / "drive.mcap", ROWS).read_bytes()


def _times() -> bytes:
    return "".join(f"{0.1 * k:.1f}\n" for k in range(ROWS)).encode()


def _kitti() -> bytes:
    return "".join(f"1 0 0 {0.1 * k:.1f} 0 1 0 0 0 0 1 0\n" for k in range(ROWS)).encode()


def _gpx() -> bytes:
    points = "".join(
        f'<trkpt lat="{48.0 + 1e-6 * k:.6f}" lon="9.0"><ele>300.0</ele>'
        f"<time>2024-05-01T12:00:{0.5 * k:04.1f}Z</time></trkpt>\n"
        for k in range(ROWS)
    )
    head = '<?xml version="1.0" encoding="UTF-8"?>\n<gpx version="1.1"><trk><trkseg>\n'
    return f"{head}{points}</trkseg></trk></gpx>\n".encode()


def _nmea() -> bytes:
    lines = []
    for k in range(ROWS):
        clock = f"1200{0.5 * k:05.2f}"
        lines.append(f"$GPGGA,{clock},4800.{100 * k:05d},N,00900.00000,E,4,12,0.6,300.0,M,48.0,M,,")
        lines.append(f"$GPRMC,{clock},A,4800.{100 * k:05d},N,00900.00000,E,0.5,0.0,010524,,,A")
    return with_sums("\r\n".join(lines).encode())


def with_sums(text: bytes) -> bytes:
    """Return sentences of NMEA with the sums that they should have, whatever stands there."""
    found = []
    for line in text.splitlines():
        body = line.partition(b"*")[0]
        found.append(b"%s*%02X\r\n" % (body, functools.reduce(lambda a, b: a ^ b, body[1:], 0)))
    return b"".join(found)


def lines_of_drive(seconds: float = 8.0) -> bytes:
    """Return a drive as lines for `slipwise live`."""
    lines = ["t,cmd_v,cmd_omega,odo_v,odo_omega,x,y,yaw,roll,pitch,override,terrain"]
    x = y = yaw = 0.0
    for k in range(round(20.0 * seconds)):
        t = 0.05 * k
        v, omega = 0.5 + 0.3 * np.sin(t / 1.5), 0.4 * np.sin(t)
        yaw += 0.9 * omega * 0.05
        x, y = x + 0.95 * v * np.cos(yaw) * 0.05, y + 0.95 * v * np.sin(yaw) * 0.05
        pose = f"{x:.4f},{y:.4f},{yaw:.4f},0.01,-0.02" if k % 2 == 0 else ",,,,"
        lines.append(f"{t:.2f},{v:.3f},{omega:.3f},{v:.3f},{omega:.3f},{pose},,{'sand' if k == 90 else ''}")
    return ("\n".join(lines) + "\n").encode()


def _json_lines() -> bytes:
    return (
        b'{"run": "tuesday"}\n{"t": 1.0, "odo_v": 0.5, "odo_omega": 0.1, "x": 0, "y": 0, "yaw": 0.1}\n'
        b'{"t": 1.1, "x": 0.1, "y": 0, "yaw": 0.1, "std_xy": 0.02, "frame": "map", "roll": 0.1, "pitch": 0}\n'
        b'{"terrain": "sand"}\n{"terrain_changed": true}\n{"t": 1.2, "cmd_v": 0.5, "cmd_omega": 0}\n'
    )


def _requests() -> bytes:
    return (
        b'{"predict": {"horizon": 2, "commands": [[8.0, 0.5, 0.1], [8.5, 0.4, 0.0]]}}\n'
        b'{"predict": {"commands": [[9, 1, 0]]}}\n{"apply": true}\n{"terrain_changed": true}\n'
    )


@functools.cache
def taught(seconds: float = 12.0) -> Any:
    """Return a learner that knows a little of a drive."""
    from slipwise.calibration import make_settings
    from slipwise.calibration.motion_learner import MotionLearner

    learner = MotionLearner("command", make_settings({"basis": "edd-2"}))
    learner.start_run("monday")
    for line in lines_of_drive(seconds).decode().splitlines()[1:]:
        cells = line.split(",")
        t, v, omega = (float(cell) for cell in cells[:3])
        learner.push_command(t, v, omega)
        learner.push_wheels(t, v, omega)
        if cells[5]:
            learner.push_pose(t, *(float(cell) for cell in cells[5:8]))
    return learner


def _saved() -> bytes:
    """The core's part of a saved learner, without what seals it."""
    from slipwise import _core

    body = _core.opened(taught().save())
    return bytes(_core.opened(body[8 + int.from_bytes(body[:8], "little") :]))


def _cache() -> bytes:
    from slipwise.calibration import make_settings
    from slipwise.live.cache import Cache, CacheKey

    with tempfile.TemporaryDirectory() as folder:
        settings = make_settings({"basis": "edd-2"})
        cache = Cache(Path(folder), CacheKey.of("robot", "command", settings))
        cache.save(taught(), None)
        return cache.state.read_bytes()


def _pgm(kind: str) -> bytes:
    if kind == "P2":
        return b"P2\n# by hand\n6 4\n255\n" + b" ".join([b"254"] * 24) + b"\n"
    return b"P5\n6 4\n255\n" + bytes([254] * 23 + [0])


_SEEDS: dict[str, tuple[Callable[[], bytes], ...]] = {
    "csv": (_csv, lambda: _csv().replace(b"\n", b"\r\n"), lambda: gzip.compress(_csv(), mtime=0)),
    "parquet": (lambda: _parquet("none"), lambda: _parquet("snappy"), lambda: _parquet("zstd")),
    "mcap": (lambda: _bag2(StoragePlugin.MCAP), lambda: _bag2(StoragePlugin.MCAP, packed=True)),
    "db3": (lambda: _bag2(StoragePlugin.SQLITE3),),
    "rosbag1": (
        lambda: _bag1(None),
        lambda: _bag1(Writer1.CompressionFormat.LZ4),
        lambda: _bag1(Writer1.CompressionFormat.BZ2),
    ),
    "calibrate": (_drive, lambda: _drive().replace(b"cmd", b"odo")),
    "model": (_model,),
    "map": (_MAP.encode,),
    "image": (lambda: _pgm("P2"), lambda: _pgm("P5")),
    "settings": (_SETTINGS.encode,),
    "kitti": (_kitti,),
    "kitti-times": (_times,),
    "gpx": (_gpx,),
    "nmea": (_nmea,),
    "nmea-checked": (_nmea,),
    "bin": (lambda: _flight("dataflash"),),
    "tlog": (lambda: _flight("tlog"),),
    "ulg": (lambda: _flight("ulog"),),
    "lines": (lines_of_drive, _json_lines),
    "requests": (_requests,),
    "cache": (_cache,),
    "learner": (_saved,),
    "foxglove": (lambda: _foxglove("ros-json"), lambda: _foxglove("foxglove-json")),
    "protobuf": (lambda: _foxglove("protobuf"), lambda: _foxglove("transforms")),
}
#: Libraries without which a kind of file can be neither written nor read.
_NEEDED = {
    "bin": ("pymavlink",),
    "tlog": ("pymavlink",),
    "ulg": ("pyulog",),
    "foxglove": ("mcap_protobuf", "pytest"),
    "protobuf": ("mcap_protobuf", "foxglove", "pytest"),
}
TARGETS = tuple(
    name for name in _SEEDS if all(importlib.util.find_spec(need) for need in _NEEDED.get(name, ()))
)
