# SPDX-License-Identifier: Apache-2.0
"""Tests of bags whose stamps, index or kind of file cannot be right."""

from __future__ import annotations

import os
import struct
from pathlib import Path

import pytest
from logs.test_bag import EPOCH, POSE, SECOND, Bag, counts, drive_along_x

from slipwise.errors import LogError
from slipwise.logs import LogOptions, open_log


@pytest.mark.parametrize("impossible", [2**63, 2**64 - 1, 2**62])
def test_messages_received_at_an_impossible_time_are_counted(tmp_path: Path, impossible: int) -> None:
    path = drive_along_x(Bag()).write(tmp_path / "a.mcap") / "a.mcap"
    content = path.read_bytes()
    for k in range(50, 100):
        stamp = struct.pack("<Q", EPOCH + k * SECOND // 10)
        content = content.replace(stamp, struct.pack("<Q", impossible))
    path.write_bytes(content)
    log = open_log(path)
    assert sum(entry.count for entry in log.left_out if entry.kind == "bad-stamp") == 100
    assert len(log.runs[0].poses) == 50


def test_a_message_that_belongs_to_another_topic_is_counted(tmp_path: Path) -> None:
    bag = drive_along_x(Bag(ros1=True))
    bag.add(EPOCH, "/chatter", POSE, bag.make(POSE, bag.header(EPOCH), bag.pose(0.0, 0.0, 0.0)))
    content = bytearray(bag.write(tmp_path / "a.bag").read_bytes())
    own, other = (struct.pack("<L", number) for number in (0, 2))  # connections, in the order written
    record = content.index(b"conn=" + own, content.index(b"op=\x02"))
    content[record + 5 : record + 9] = other
    (tmp_path / "b.bag").write_bytes(content)
    log = open_log(tmp_path / "b.bag", options=LogOptions(pose_topic="/mocap/robot"))
    assert counts(log)["bad-message"] == 1


def test_a_pipe_in_the_place_of_a_bag_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.mcap")
    for path in (tmp_path, tmp_path / "a.mcap"):
        with pytest.raises(LogError, match=r"not a regular file \(.*a\.mcap\)"):
            open_log(path)
