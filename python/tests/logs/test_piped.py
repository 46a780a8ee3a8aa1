# SPDX-License-Identifier: Apache-2.0
"""Logs through a pipe are read like files; what can be no log is refused."""

from __future__ import annotations

import gzip
import os
import subprocess
import sys
from pathlib import Path

import pytest
from sample_bags import Bag, drive_along_x

from slipwise.errors import LogError
from slipwise.logs import open_log, piped


def through_stdin(content: bytes, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "slipwise", *arguments]
    return subprocess.run(command, input=content, capture_output=True, timeout=60, check=False)


def test_a_bag_through_standard_input_is_read_more_than_once(tmp_path: Path) -> None:
    content = (drive_along_x(Bag()).write(tmp_path / "a.mcap") / "a.mcap").read_bytes()
    done = through_stdin(content, "inspect", "/dev/stdin")
    assert done.returncode == 0, done.stderr
    assert b"/dev/stdin: mcap" in done.stdout
    assert b"/mocap/robot" in done.stdout


def test_what_is_wrong_with_a_piped_log_names_standard_input() -> None:
    done = through_stdin(b"t,x\n0,1\n", "convert", "/dev/stdin", "-o", "/dev/null/x.csv")
    assert done.returncode == 2
    done = through_stdin(bytes(range(256)), "inspect", "/dev/stdin")
    assert (done.returncode, done.stderr) == (
        2,
        b"slipwise: not a text file (/dev/stdin): give a CSV, Parquet or bag file\n",
    )


def test_a_pipe_of_a_shell_is_read_and_named(tmp_path: Path) -> None:
    reader, writer = os.pipe()
    content = gzip.compress(b"t,cmd_v,cmd_omega,x,y,yaw\n0,1,0,0,0,0\n1,1,0,1,0,0\n")
    os.write(writer, content)
    os.close(writer)
    log = open_log(f"/dev/fd/{reader}")
    assert log.sources[0].path == f"/dev/fd/{reader}"
    assert len(log.runs[0].poses) == 2
    assert len(open_log(f"/dev/fd/{reader}").runs[0].poses) == 2
    os.close(reader)


def test_too_much_through_a_pipe_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(piped, "LARGEST", 10)
    reader, writer = os.pipe()
    os.write(writer, b"x" * 100)
    os.close(writer)
    with pytest.raises(LogError, match=r"came through the pipe .*: save it to a file"):
        open_log(f"/dev/fd/{reader}")
    os.close(reader)


def test_devices_and_named_pipes_are_no_logs(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", Path("/dev/zero")):
        with pytest.raises(LogError, match=r"not a regular file .*: save it to a file"):
            open_log(path)
