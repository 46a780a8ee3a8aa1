# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, a full disk and a locked folder end a command in one line and leave no half-written file."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cli.conftest import Columns, Result, left_in, write_csv

pytestmark = pytest.mark.slow

Slipwise = Callable[..., Result]

STOPPED = "stopped by the user; no half-written file is left"


@pytest.fixture
def long_csv(folder: Path, columns: Columns) -> Path:
    """Twenty-four minutes of driving: the same minute and a half over and over, each a frame of its own."""
    times = 16
    tiled = {name: np.tile(values, times) for name, values in columns.items()}
    tiled["frame"] = np.repeat(np.arange(times, dtype=np.float64), len(columns["t"]))
    tiled["t"] += (columns["t"][-1] + 0.05) * tiled["frame"]
    return write_csv(folder / "long.csv", tiled)


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(
    "arguments",
    [
        ["calibrate", "long.csv", "-o", "model.yaml"],
        ["evaluate", "long.csv", "--predictions", "predictions.csv"],
    ],
)
def test_ctrl_c_while_learning_leaves_nothing(
    interrupted: Slipwise, long_csv: Path, arguments: list[str], sent: signal.Signals
) -> None:
    runs = long_csv.parent / "runs"
    result = interrupted(*arguments, at_work=lambda _: runs.exists(), sent=sent)
    assert (result.code, result.out, result.line) == (2, "", STOPPED)
    assert left_in(long_csv.parent) == {"long.csv"}


def test_a_signal_that_another_thread_gets_while_the_folder_is_made_leaves_nothing(folder: Path) -> None:
    program = """
import os, signal, sys, threading, time
from pathlib import Path
from slipwise.cli.errors import exit_code_of
from slipwise.cli.run_folder import run_folder

threading.Thread(target=threading.Event().wait, daemon=True).start()
made = Path.mkdir

def mkdir(path, *mode, **how):
    made(path, *mode, **how)
    if path.name != "runs":
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.1)

Path.mkdir = mkdir

def command():
    with run_folder(Path("runs"), "calibrate"):
        return 0

sys.exit(exit_code_of(command, debug=False))
"""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr, left_in(folder)) == (2, f"slipwise: {STOPPED}\n", set())


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_while_python_compiles_a_text_ends_with_the_same_code(
    folder: Path, sent: signal.Signals
) -> None:
    stop = f"import os; os.kill(os.getpid(), {int(sent)}); [None for _ in range(1000)]"
    program = f"""
import sys
from slipwise.cli.errors import exit_code_of
sys.exit(exit_code_of(lambda: exec({stop!r}), debug=False))
"""
    (folder / "stopped.py").write_text(program)
    command = [sys.executable, "-m", "stopped"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, f"slipwise: {STOPPED}\n")


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_that_comes_where_python_ignores_what_is_raised_ends_the_command_too(
    folder: Path, sent: signal.Signals
) -> None:
    program = f"""
import os, sys, time, weakref
from slipwise.cli.errors import exit_code_of

def gone(_):
    os.kill(os.getpid(), {int(sent)})
    [None for _ in range(1000)]

class Held:
    pass

def command():
    held = Held()
    kept = weakref.ref(held, gone)
    del held
    time.sleep(1e6)
    return 0

sys.exit(exit_code_of(command, debug=False))
"""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert (done.returncode, done.stderr) == (2, f"slipwise: {STOPPED}\n")


def has_begun(pid: int) -> bool:
    """Whether a process simulates; one that has ended meanwhile does not."""
    try:
        return "libmujoco" in Path(f"/proc/{pid}/maps").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_ctrl_c_while_simulating_leaves_nothing(interrupted: Slipwise, folder: Path) -> None:
    pytest.importorskip("mujoco")

    if not Path("/proc/self/maps").exists():
        pytest.skip("no /proc to see whether the simulation has begun")
    result = interrupted("simulate", "-o", "drive.mcap", "--duration", "36000", at_work=has_begun)
    assert (result.code, result.out, result.line) == (2, "", STOPPED)
    assert left_in(folder) == set()


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_the_workers_of_a_reproduction_too(
    interrupted: Slipwise, folder: Path, sent: signal.Signals
) -> None:
    for library in ("mujoco", "matplotlib", "sklearn"):
        pytest.importorskip(library)
    workers: set[int] = set()

    def simulating(pid: int) -> bool:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        workers.update(child for child in map(int, children) if has_begun(child))
        return bool(workers)

    if not Path("/proc/self/maps").exists():
        pytest.skip("no /proc to see whether the workers have begun")
    result = interrupted("reproduce", "thesis", "--only", "chapter-4", at_work=simulating, sent=sent)
    assert (result.code, result.out, result.line) == (2, "", STOPPED)
    assert left_in(folder) == set()
    assert not any(Path(f"/proc/{worker}").exists() for worker in workers)


def test_ctrl_c_while_writing_leaves_the_old_file(interrupted: Slipwise, long_csv: Path) -> None:
    old = long_csv.parent / "long.mcap"
    old.write_text("old")

    def writing(_: int) -> bool:
        return any(long_csv.parent.glob(".slipwise-*.part/bag/*"))

    result = interrupted("convert", "long.csv", "-o", "long.mcap", at_work=writing)
    assert (result.code, result.out, result.line) == (2, "", STOPPED)
    assert left_in(long_csv.parent) == {"long.csv", "long.mcap"}
    assert old.read_text() == "old"


@pytest.mark.slow
def test_what_a_killed_conversion_leaves_is_swept_by_the_next(
    interrupted: Slipwise, slipwise: Slipwise, long_csv: Path
) -> None:
    def writing(_: int) -> bool:
        return any(long_csv.parent.glob(".slipwise-*.part/bag/*"))

    result = interrupted("convert", "long.csv", "-o", "long.mcap", at_work=writing, sent=signal.SIGKILL)
    assert result.code == -signal.SIGKILL
    assert any(long_csv.parent.glob(".slipwise-*.part"))
    assert slipwise("convert", "long.csv", "-o", "again.csv").code == 0
    assert left_in(long_csv.parent) == {"long.csv", "again.csv"}


@pytest.mark.parametrize(
    "arguments",
    [
        ["convert", "drive.csv", "-o", "small/drive.csv"],
        ["convert", "drive.csv", "-o", "small/drive.mcap"],
        ["calibrate", "drive.csv", "--runs", "small/runs"],
        ["evaluate", "drive.csv", "--predictions", "small/predictions.csv"],
    ],
)
def test_a_full_disk_is_said_and_nothing_is_left_on_it(
    with_mount: Slipwise, drive_csv: Path, arguments: list[str]
) -> None:
    result = with_mount("size=32k", *arguments)
    assert (result.code, result.out) == (2, "")
    assert result.line.startswith("cannot write: No space left on device (small/")
    assert result.line.endswith("the disk is full, free some space or choose another folder")


@pytest.mark.parametrize(
    "arguments",
    [
        ["calibrate", "drive.csv", "-o", "small/model.yaml"],
        ["calibrate", "drive.csv", "--runs", "small/runs"],
        ["evaluate", "drive.csv", "--json", "small/scores.json"],
        ["convert", "drive.csv", "-o", "small/drive.parquet"],
        ["simulate", "-o", "small/drive.mcap"],
        ["demo", "--output", "small/demo"],
    ],
)
def test_a_read_only_folder_is_said_before_the_work(
    with_mount: Slipwise, drive_csv: Path, arguments: list[str]
) -> None:
    result = with_mount("ro", *arguments)
    assert (result.code, result.out) == (2, "")
    assert result.line.startswith("cannot write: Read-only file system (small/")


def test_a_folder_without_permission_is_said(slipwise: Slipwise, drive_csv: Path) -> None:
    locked = drive_csv.parent / "locked"
    locked.mkdir(mode=0o555)
    if os.access(locked, os.W_OK):
        pytest.skip("this user may write anywhere; the read-only folder is tested above")
    result = slipwise("calibrate", drive_csv, "-o", "locked/model.yaml")
    assert result.code == 2
    assert (
        result.line == "cannot write: Permission denied (locked/model.yaml): choose a folder you may write to"
    )


@pytest.mark.parametrize("option", ["--output", "--report", "--json"])
def test_a_path_below_a_file_is_said(slipwise: Slipwise, drive_csv: Path, option: str) -> None:
    result = slipwise("calibrate", drive_csv, option, "drive.csv/result")
    assert result.code == 2
    assert result.line.startswith(f"cannot write: {os.strerror(errno.ENOTDIR)} (drive.csv/result)")
    assert left_in(drive_csv.parent) == {"drive.csv"}


def test_a_folder_in_place_of_a_file_is_said(slipwise: Slipwise, drive_csv: Path) -> None:
    (drive_csv.parent / "model.yaml").mkdir()
    result = slipwise("calibrate", drive_csv, "-o", "model.yaml")
    assert (result.code, result.line) == (
        2,
        "cannot write: Is a directory (model.yaml): this is a folder, name a file",
    )


def test_a_device_is_not_replaced_by_a_file(slipwise: Slipwise, drive_csv: Path) -> None:
    pipe = drive_csv.parent / "pipe"
    os.mkfifo(pipe)
    result = slipwise("calibrate", drive_csv, "--json", "pipe")
    assert result.code == 2
    assert result.line.startswith("not a file (pipe)")
    assert pipe.is_fifo()


def test_a_reader_that_leaves_early_is_no_error(drive_csv: Path) -> None:
    shell = (
        f"{sys.executable} -m slipwise calibrate drive.csv --no-report | head -n 1; exit ${{PIPESTATUS[0]}}"
    )
    done = subprocess.run(
        ["bash", "-c", shell], cwd=drive_csv.parent, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1


def test_standard_output_on_a_full_disk_is_said(drive_csv: Path) -> None:
    command = [sys.executable, "-m", "slipwise", "inspect", "drive.csv", "--json", "-"]
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run(
            command, cwd=drive_csv.parent, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 2
    assert done.stderr == "slipwise: cannot write: No space left on device (stdout)\n"


def test_ctrl_c_while_modules_load_shows_no_traceback(folder: Path) -> None:
    program = """
import os, signal, sys

class Interrupter:
    def find_spec(self, name, *_):
        if name == "slipwise.cli.main":
            os.kill(os.getpid(), signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)  # whatever the tests were started with
sys.meta_path.insert(0, Interrupter())
from slipwise.__main__ import main
main()
"""
    command = [sys.executable, "-c", program, "--version"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")
