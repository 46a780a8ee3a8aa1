# SPDX-License-Identifier: Apache-2.0
"""`slipwise fleet` learns logs once, writes rows, page and prior, and stops cleanly."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.conftest import Result
from fleet.test_learned_rows import write_log

Slipwise = Callable[..., Result]
KEPT = "rows/*/*/*.parquet"


def write_fleet(folder: Path, logs: int, seconds: float) -> None:
    """Write logs of two vehicles, and one that cannot be used."""
    for vehicle in ("red", "blue"):
        (folder / "logs" / vehicle).mkdir(parents=True)
        for k in range(logs):
            write_log(folder / "logs" / vehicle / f"{k}.csv", 10 * k + len(vehicle), seconds)
    (folder / "logs" / "red" / "bad.csv").write_text("t,speed\n0,1\n", encoding="utf-8")


@pytest.mark.slow
def test_fleet_learns_once_and_writes_rows_page_and_prior(slipwise: Slipwise, folder: Path) -> None:
    write_fleet(folder, 1, 40.0)
    result = slipwise("fleet", "logs", "-o", "out", "--workers", "2", "--json", "first.json")
    assert (result.code, result.err) == (0, "")
    assert "2 logs of 2 vehicles" in result.out
    assert Path("out/fleet.html").exists()
    assert "ang.w" in Path("out/fleet.yaml").read_text(encoding="utf-8")
    assert len(list(Path("out/rows").rglob("vehicle=red/month=*/*.parquet"))) == 1
    count = json.loads(Path("first.json").read_text(encoding="utf-8"))["count"]
    assert (count["learned"], count["unusable"]) == (2, 1)
    again = json.loads(slipwise("fleet", "logs", "-o", "out", "--json", "-").out)["count"]
    assert (again["learned"], again["known"]) == (0, 3)


def _lives(group: int) -> bool:
    """Whether a process of the group is there."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def children_of(pid: int) -> list[str]:
    """Return the command lines of a process's children."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    lines = []
    for child in children:
        with contextlib.suppress(OSError):
            lines.append(Path(f"/proc/{child}/cmdline").read_text())
    return lines


@pytest.mark.slow
def test_interrupted_fleet_leaves_whole_files_and_no_process(folder: Path) -> None:
    write_fleet(folder, 4, 60.0)
    command = [sys.executable, "-m", "slipwise", "fleet", "logs", "-o", "out", "--workers", "2"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True) as process:
        limit = time.monotonic() + 120.0
        while not list(Path("out").glob(KEPT)) and time.monotonic() < limit:
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=60.0)
        while _lives(process.pid) and time.monotonic() < limit:
            time.sleep(0.1)
        assert not _lives(process.pid)
    import pyarrow.parquet as parquet

    kept = list(Path("out").glob(KEPT))
    assert kept
    assert all(parquet.read_table(path).num_rows for path in kept)
    assert not list(Path("out").rglob(".slipwise-*"))


@pytest.mark.slow
def test_ctrl_c_while_workers_of_a_fleet_begin_is_said_in_one_line(folder: Path) -> None:
    if not Path("/proc/self/task").exists():
        pytest.skip("no /proc to see whether a worker has begun")
    write_fleet(folder, 2, 60.0)
    command = [sys.executable, "-m", "slipwise", "fleet", "logs", "-o", "out", "--workers", "2"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True) as process:
        while not any("spawn_main" in each for each in children_of(process.pid)):
            assert process.poll() is None
            time.sleep(0.002)
        time.sleep(0.05)  # Python begins: it has no handler of ours yet
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60.0)
    assert process.returncode == 2
    assert said.decode().splitlines() == ["slipwise: stopped by the user; no half-written file is left"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), "no such file"),
        ((".",), "no log"),
        ((".", "--settings", "no.toml"), "no"),
        ((".", "--workers", "0"), "give 1 or more"),
    ],
)
def test_wrong_use_ends_with_code_2_and_says_why(
    slipwise: Slipwise, folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    result = slipwise("fleet", *arguments)
    assert result.code == 2
    assert message in result.err


@pytest.mark.slow
def test_calibrate_begins_with_the_prior_that_fleet_wrote(slipwise: Slipwise, folder: Path) -> None:
    write_fleet(folder, 1, 40.0)
    assert slipwise("fleet", "logs", "-o", "out", "--type", "rover", "--workers", "1").code == 0
    write_log(folder / "new.csv", 99, 30.0)
    result = slipwise("calibrate", "new.csv", "--prior", "out/fleet.yaml", "--no-report")
    assert result.code in (0, 1)
    assert "out/fleet.yaml" in result.out
    refused = slipwise("calibrate", "--memory", "new.csv", "--prior", "out/fleet.yaml")
    assert refused.line.startswith("a fleet's prior is of one log on one surface")
