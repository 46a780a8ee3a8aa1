# SPDX-License-Identifier: Apache-2.0
"""A recording is one bag that others read back, whole or not at all, and what a killed process leaves."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from live.sample_outputs import driven_outputs, next_moves, odometry_at, straight_path, waiting_status
from rosbags.rosbag2 import Reader

from slipwise.errors import OutputError
from slipwise.live.outputs import Note
from slipwise.live.ros_messages import RosMessages
from slipwise.live.watch.recorder import Recorder
from slipwise.logs.bag_file import BagFile, bag_files
from slipwise.logs.left_out import Tally

KILLED = """
import sys, time
from pathlib import Path
from live.sample_outputs import odometry_at
from slipwise.live.watch import recorder
recorder.SAVED_EVERY = 0.2
watcher = recorder.Recorder(Path(sys.argv[1]))
for i in range(10**6):
    watcher.take(odometry_at(1.0 + 0.01 * i))
    if i == 400:
        print("ready", flush=True)
    time.sleep(0.002)
"""


def _record(path: Path) -> None:
    recorder = Recorder(path)
    for output in (*driven_outputs(), straight_path(asked=True), next_moves()):
        recorder.take(output)
    recorder.close()
    assert recorder.notices() == []


def test_all_outputs_are_read_back_in_their_order(tmp_path: Path) -> None:
    path = tmp_path / "out.mcap"
    _record(path)
    messages = RosMessages()
    outputs = (*driven_outputs(), straight_path(asked=True), next_moves())
    expected = [message for output in outputs for message in messages.of(output)]
    with Reader(path) as reader:
        read = [(c.topic, c.msgtype, bytes(data)) for c, _, data in reader.messages()]
        latched = {c.topic: "transient_local" in str(c.ext).lower() for c in reader.connections}
    assert sorted(read) == sorted((f"/slipwise/{m.topic}", m.type, m.payload) for m in expected)
    assert [topic for topic, kept in latched.items() if kept] == [
        "/slipwise/model",
        "/slipwise/surface",
        "/slipwise/surface_json",
        "/slipwise/next_moves",
    ]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out.mcap"]


def test_slipwise_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "out.mcap"
    _record(path)
    tally = Tally()
    with BagFile(path, bag_files(path), tally) as bag:
        counts = {topic.name: topic.count for topic in bag.topics}
        poses = [bag.decode(message).pose.pose.position.x for message in bag.messages({"/slipwise/odometry"})]
    assert counts["/slipwise/odometry"] == len(poses) == 400
    assert counts["/slipwise/model"] == 1


def test_before_its_end_there_is_no_file_and_the_old_one_stays(tmp_path: Path) -> None:
    path = tmp_path / "out.mcap"
    path.write_bytes(b"old")
    recorder = Recorder(path)
    recorder.take(odometry_at(1.0))
    assert path.read_bytes() == b"old"
    recorder.close()
    recorder.close()
    with Reader(path) as reader:
        assert reader.message_count == 2


def test_an_empty_recording_is_a_bag(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "out.mcap")
    recorder.close()
    assert recorder.notices() == []
    with BagFile(tmp_path / "out.mcap", [tmp_path / "out.mcap"], Tally()) as bag:
        assert sum(topic.count for topic in bag.topics) == 0


def test_what_has_no_stamp_is_filed_with_the_one_before(tmp_path: Path) -> None:
    path = tmp_path / "out.mcap"
    recorder = Recorder(path)
    for output in (odometry_at(7.0), waiting_status(t=float("nan")), Note(float("inf"), "x")):
        recorder.take(output)
    recorder.close()
    with Reader(path) as reader:
        assert {t for _, t, _ in reader.messages()} == {7_000_000_000}


def test_two_recorders_do_not_share_a_file(tmp_path: Path) -> None:
    first = Recorder(tmp_path / "out.mcap")
    with pytest.raises(OutputError, match="another process records to this file"):
        Recorder(tmp_path / "out.mcap")
    first.close()
    assert (tmp_path / "out.mcap").is_file()


def test_a_folder_and_a_place_that_is_none_are_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="not a file"):
        Recorder(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write"):
        Recorder(tmp_path / "file" / "out.mcap")


def test_what_others_put_in_the_way_is_left_alone(tmp_path: Path) -> None:
    part = tmp_path / "out.mcap.part"
    part.write_text("mine")
    with pytest.raises(OutputError, match="in the way"):
        Recorder(tmp_path / "out.mcap")
    assert part.read_text() == "mine"
    part.unlink()
    part.mkdir()
    (part / "thesis.tex").write_text("mine")
    with pytest.raises(OutputError, match="in the way"):
        Recorder(tmp_path / "out.mcap")
    assert (part / "thesis.tex").read_text() == "mine"


def test_a_full_disk_ends_the_recording_and_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder(tmp_path / "out.mcap")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(recorder._writer, "write", full)
    recorder.take(odometry_at(1.0))
    recorder.close()
    recorder.take(odometry_at(2.0))
    (said,) = recorder.notices()
    assert "No space left on device" in said
    assert "out.mcap.part" in said
    assert not (tmp_path / "out.mcap").exists()


@pytest.mark.slow
def test_a_killed_process_leaves_what_slipwise_reads_and_the_next_one_keeps(tmp_path: Path) -> None:
    path = tmp_path / "out.mcap"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)], stdout=subprocess.PIPE, text=True, env=environment
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(1.0)
        process.send_signal(signal.SIGKILL)
    assert not path.exists()
    left = tmp_path / "out.mcap.part"
    assert _odometry_count(left) > 400
    recorder = Recorder(path)
    (said,) = recorder.notices()
    kept = tmp_path / "out-recovered-1.mcap"
    assert str(kept) in said
    recorder.take(odometry_at(1.0))
    recorder.close()
    assert _odometry_count(kept) > 400
    assert _odometry_count(path) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out-recovered-1.mcap", "out.mcap"]


def _odometry_count(path: Path) -> int:
    with BagFile(path, bag_files(path), Tally()) as bag:
        return sum(1 for _ in bag.messages({"/slipwise/odometry"}))
