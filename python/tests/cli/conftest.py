# SPDX-License-Identifier: Apache-2.0
"""A slipping robot's log as a table to damage, and ways to run the command line, here or as a process."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_logs import Drive, simulated_run

from slipwise import _core
from slipwise.cli.main import run

Columns = dict[str, NDArray[np.float64]]

EDD_2 = _core.named_basis("edd-2")
LONG = 60.0  # s, until a process that hangs counts as a failure
HANGS = 600.0  # s of the clock, until one that is to begin its work and has not used `LONG` does


@dataclass(frozen=True)
class Result:
    """How a command ended."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self.out)
        return document

    @property
    def line(self) -> str:
        """The one line that an error is; notes about older names may stand before it."""
        assert self.err.endswith("\n")
        said = [line for line in self.err.splitlines() if not line.startswith("note: ")]
        assert len(said) == 1, self.err
        assert said[0].startswith("slipwise: ")
        return said[0].removeprefix("slipwise: ")


def make_columns(drive: Drive) -> Columns:
    """Return the drive as columns of a tidy log."""
    made = simulated_run(drive)
    assert made.commands is not None
    assert made.wheels is not None
    return {
        "t": made.commands.t,
        "cmd_v": made.commands.v,
        "cmd_omega": made.commands.omega,
        "odo_v": made.wheels.v,
        "odo_omega": made.wheels.omega,
        "x": made.poses.x,
        "y": made.poses.y,
        "yaw": made.poses.yaw,
    }


def write_csv(path: Path, columns: Columns) -> Path:
    np.savetxt(
        path,
        np.column_stack(list(columns.values())),
        delimiter=",",
        header=",".join(columns),
        comments="",
        fmt="%.9g",
    )
    return path


@pytest.fixture(scope="session")
def _slipping() -> Columns:
    return make_columns(Drive(seconds=90.0, basis=EDD_2, alpha=(-0.1, -0.3)))


@pytest.fixture
def columns(_slipping: Columns) -> Columns:
    """A minute and a half of a robot that turns 30 % less than it is commanded; to be damaged."""
    return {name: values.copy() for name, values in _slipping.items()}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder of the command."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def drive_csv(folder: Path, columns: Columns) -> Path:
    """A sound log."""
    return write_csv(folder / "drive.csv", columns)


@pytest.fixture
def slipwise(folder: Path, capfd: pytest.CaptureFixture[str]) -> Callable[..., Result]:
    """Run the command line in this process."""

    def call(*arguments: object) -> Result:
        capfd.readouterr()
        code = run([str(argument) for argument in arguments])
        return Result(code, *capfd.readouterr())

    return call


def _command(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "slipwise", *map(str, arguments)]


@pytest.fixture
def process(folder: Path) -> Callable[..., Result]:
    """Run the command line as a process of its own."""

    def call(*arguments: object) -> Result:
        done = subprocess.run(
            _command(*arguments), cwd=folder, capture_output=True, text=True, timeout=LONG, check=False
        )
        return Result(done.returncode, done.stdout, done.stderr)

    return call


@pytest.fixture
def interrupted(folder: Path) -> Callable[..., Result]:
    """Run the command line as a process and stop it, as Ctrl-C does, once it is at work."""

    def call(
        *arguments: object, at_work: Callable[[int], bool], sent: signal.Signals = signal.SIGINT
    ) -> Result:
        child = subprocess.Popen(
            _command(*arguments), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        try:
            until = time.monotonic() + HANGS
            while not at_work(child.pid):
                assert child.poll() is None, child.communicate()
                assert time.monotonic() < until
                assert processor_time(child.pid) < LONG
                time.sleep(0.01)
            child.send_signal(sent)
            out, err = child.communicate(timeout=LONG)
        finally:
            child.kill()
        return Result(child.returncode, out, err)

    return call


def processor_time(pid: int) -> float:
    """How long a process has computed [s]; 0 where the system does not say."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.fixture
def with_mount(folder: Path) -> Callable[..., Result]:
    """Run the command line where `small` is a mounted tmpfs; its content afterwards stands in `out`."""
    unshare = [shutil.which("unshare") or "unshare", "-m" if os.geteuid() == 0 else "-rm"]
    tried = subprocess.run(
        [*unshare, "mount", "-t", "tmpfs", "tmpfs", str(folder)], capture_output=True, check=False
    )
    if tried.returncode != 0:
        pytest.skip(f"a tmpfs cannot be mounted here: {tried.stderr.decode().strip()}")

    def call(options: str, *arguments: object) -> Result:
        (folder / "small").mkdir()
        script = f'mount -t tmpfs -o {options} tmpfs small && {{ "$@"; code=$?; ls -A small; exit $code; }}'
        command = [*unshare, "sh", "-c", script, "sh", *_command(*arguments)]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=LONG, check=False)
        return Result(done.returncode, done.stdout, done.stderr)

    return call


def left_in(folder: Path) -> set[str]:
    """Return the files below a folder, hidden ones too."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}
