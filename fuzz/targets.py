# SPDX-License-Identifier: Apache-2.0
"""What is fuzzed: each reader, called with a file of given bytes; all but a plain refusal is a finding."""

from __future__ import annotations

import contextlib
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from seeds import lines_of_drive, taught, with_sums

from slipwise import _core
from slipwise.errors import SettingsError, SlipwiseError
from slipwise.logs import open_log, save_log, unpacking

if TYPE_CHECKING:
    from slipwise.calibration.motion_learner import MotionLearner

unpacking.MOST_UNPACKED = 16.0  # MiB
_ENDINGS = {
    "rosbag1": ".bag",
    "calibrate": ".csv",
    "model": ".yaml",
    "map": ".yaml",
    "image": ".pgm",
    "settings": ".toml",
    "kitti": ".txt",
    "nmea-checked": ".nmea",
    "kitti-times": "_times.txt",
    "foxglove": ".mcap",
    "protobuf": ".mcap",
}
_ROWS = 30  # of the seeds of KITTI
_BESIDE = {  # by target: a file that the one that is read needs
    "map": ("map.pgm", b"P5\n6 4\n255\n" + bytes([254] * 24)),
    "kitti": ("input_times.txt", b"".join(b"%.1f\n" % (0.1 * k) for k in range(_ROWS))),
    "kitti-times": ("input.txt", b"".join(b"1 0 0 %.1f 0 1 0 0 0 0 1 0\n" % (0.1 * k) for k in range(_ROWS))),
}
NEVER_REFUSED = ("lines", "requests")  # what is wrong with them is counted
_CONVERTED = 7  # every so many logs are written again too


class Target:
    """A reader with a file to read from, in memory where the system allows."""

    def __init__(self, name: str) -> None:
        self.name = name
        shared = Path("/dev/shm")
        self._folder = tempfile.TemporaryDirectory(dir=shared if shared.is_dir() else None)
        self._path = Path(self._folder.name) / f"input{_ENDINGS.get(name, '.' + name)}"
        self._read = _READERS.get(name, _read_log)
        warnings.simplefilter("error", RuntimeWarning)
        self._own = {self._path.name}
        if name in _BESIDE:
            beside, content = _BESIDE[name]
            (self._path.parent / beside).write_bytes(content)
            self._own.add(beside)

    def run(self, data: bytes) -> str:
        """Read the bytes; return what a plain refusal said, or nothing.

        Raises:
            Exception: anything that is not a plain refusal of one line: a finding.
        """
        self._path.write_bytes(data)
        try:
            self._read(self._path)
        except SlipwiseError as error:
            line = str(error)
            if "\n" in line or "Traceback" in line:
                raise AssertionError("a refusal is one line") from error
            return line
        finally:
            left = {item.name for item in self._path.parent.iterdir()} - self._own
            if left:
                raise AssertionError(f"files are left behind: {left}")
        return ""

    def run_unread(self, data: bytes) -> None:
        """Run without a result, as libFuzzer wants it."""
        self.run(data)


def _read_log(path: Path) -> None:
    log = open_log(path)
    for run in log.runs:
        assert np.isfinite(run.poses.x).all()
    if sum(len(run.poses) for run in log.runs) % _CONVERTED == 1:
        written = path.with_name("written.mcap")
        try:
            save_log(log, written)
            open_log(written)
        finally:
            written.unlink(missing_ok=True)


def _read_poses(path: Path) -> None:
    from slipwise.logs.left_out import Tally
    from slipwise.logs.pose_file import read_pose_file

    stream = read_pose_file(path, {}, Tally()).stream
    assert np.isfinite(stream.t).all()


def _read_checked(path: Path) -> None:
    path.write_bytes(with_sums(path.read_bytes()))
    _read_poses(path)


def _read_times(path: Path) -> None:
    _read_poses(path.with_name("input.txt"))


def _learn(path: Path) -> None:
    from slipwise.calibration import calibrate, make_settings

    result = calibrate(open_log(path), settings=make_settings({"basis": "edd-2"}))
    assert np.isfinite(result.model.mean).all()


def _read_model(path: Path) -> None:
    from slipwise.models import load_model
    from slipwise.prediction import predict

    model = load_model(path)
    found = predict(model, [(0.0, 1.0, 0.3)], horizon=1.0)
    assert np.isfinite(found.poses).all()


def _read_map(path: Path) -> None:
    from slipwise.planning import load_map

    load_map(path, most_cells=1_000_000).clearance_at([[0.0, 0.0], [1e9, -1e9]])


def _read_image(path: Path) -> None:
    from slipwise.planning.pgm import read_pgm

    assert np.isfinite(read_pgm(path, most_pixels=1_000_000)).all()


def _read_settings(path: Path) -> None:
    from slipwise.calibration import load_settings

    settings = load_settings(path)
    settings.bases()
    settings.filter_settings()


def _survive_lines(path: Path, before: bytes = b"", after: bytes = b"") -> None:
    """Run a node on the lines: it must end in order, and nothing in it may have failed."""
    import io

    from slipwise.calibration import make_settings
    from slipwise.live.build import build_node
    from slipwise.live.pipe import Pipe

    settings = make_settings({"basis": "edd-2"})
    lines = io.BytesIO(before + path.read_bytes() + after)
    built = build_node(Pipe(lines, io.BytesIO()), "command", settings, run="lines")
    built.node.run()
    failed = [reason for reason in built.said.counts if reason.endswith(" failed")]
    assert not failed, [text for _, text in built.said.log() if "failed" in text]


def _survive_requests(path: Path) -> None:
    _survive_lines(path, before=lines_of_drive(), after=b"\n")


def _load_cache(path: Path) -> None:
    from slipwise.calibration import make_settings
    from slipwise.live.cache import Cache, CacheKey

    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        cache = Cache(Path(folder), CacheKey.of("robot", "command", make_settings({"basis": "edd-2"})))
        cache.state.write_bytes(path.read_bytes())
        found = cache.load()
        cache.close()
    if found.learner is None:
        raise SettingsError(found.said)
    _use(found.learner)


def _load_learner(path: Path) -> None:
    """Of a saved learner whose content is wrong and whose checksums are right."""
    from slipwise.calibration.motion_learner import MotionLearner

    head = _core.opened(taught().save())
    head = head[: 8 + int.from_bytes(head[:8], "little")]
    _use(MotionLearner.load(_core.sealed(head + _core.sealed(path.read_bytes()))))


def _use(learner: MotionLearner) -> None:
    """Judge, predict and learn further; a learner of nonsense may say that it cannot."""
    with contextlib.suppress(SlipwiseError, ValueError):
        learner.judged_model(limits=False)
    newest = learner.odometry()
    t = 0.0 if newest is None else newest.t
    with contextlib.suppress(SlipwiseError):
        learner.predict([(t + 0.1, 0.5, 0.1)], horizon=1.0)
    for k in range(1, 80):
        now = t + 0.05 * k
        learner.push_command(now, 0.5, 0.1)
        learner.push_wheels(now, 0.5, 0.1)
        learner.push_pose(now, 0.02 * k, 0.0, 0.005 * k)
    learner.odometry()
    learner.motion_monitor()
    learner.events()
    learner.start_run("another")
    learner.save()


_READERS: dict[str, Callable[[Path], None]] = {
    "calibrate": _learn,
    "lines": _survive_lines,
    "requests": _survive_requests,
    "cache": _load_cache,
    "learner": _load_learner,
    "kitti": _read_poses,
    "kitti-times": _read_times,
    "gpx": _read_poses,
    "nmea": _read_poses,
    "nmea-checked": _read_checked,
    "model": _read_model,
    "map": _read_map,
    "image": _read_image,
    "settings": _read_settings,
}
