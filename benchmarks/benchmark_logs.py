# SPDX-License-Identifier: Apache-2.0
"""Measures how long logs take to open: one million rows of tidy CSV, and 100 000 messages of a bag."""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from slipwise.logs import Inputs, Log, Poses, Run, open_log, save_log

ROWS = 1_000_000
MESSAGES = 100_000


@dataclass(frozen=True)
class Figure:
    """One measurement."""

    name: str
    size: int
    megabytes: float
    best_s: float
    median_s: float
    limit_s: float


def make_run(name: str, *, count: int, start: float, seed: int) -> Run:
    """Make a drive of `count` stamps at 20 Hz with a pose, a command and a wheel speed at each."""
    rng = np.random.default_rng(seed)
    t = np.round(start + 0.05 * np.arange(count), 3)
    v = rng.uniform(-1.0, 2.0, count)
    omega = rng.uniform(-1.0, 1.0, count)
    yaw = np.cumsum(0.05 * omega)
    x, y = np.cumsum(0.05 * v * np.cos(yaw)), np.cumsum(0.05 * v * np.sin(yaw))
    inputs = Inputs(t=t, v=v, vy=np.zeros(count), omega=omega)
    wrapped = np.arctan2(np.sin(yaw), np.cos(yaw))
    poses = Poses(t=t, x=x, y=y, yaw=wrapped, frame=np.zeros(count, np.int64))
    return Run(name=name, commands=inputs, wheels=inputs, poses=poses)


def make_log(count: int, runs: int) -> Log:
    """Make a log of `count` stamps in `runs` runs."""
    each = count // runs
    return Log(tuple(make_run(f"run{i}", count=each, start=i * 0.06 * each, seed=i) for i in range(runs)))


def measure(name: str, path: Path, *, size: int, limit_s: float, repeats: int) -> Figure:
    """Open the file several times."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        open_log(path)
        times.append(time.perf_counter() - start)
    return Figure(name, size, path.stat().st_size / 1e6, min(times), statistics.median(times), limit_s)


def main() -> int:
    """Run the benchmark; exit code 1 if a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_log(make_log(ROWS, 10), folder / "rows.csv")
        save_log(make_log(MESSAGES // 3, 1), folder / "messages.mcap")
        figures = [
            measure("tidy CSV, rows", folder / "rows.csv", size=ROWS, limit_s=2.0, repeats=arguments.repeats),
            measure(
                "MCAP, messages",
                folder / "messages.mcap",
                size=MESSAGES,
                limit_s=1.5,
                repeats=arguments.repeats,
            ),
        ]
    print(f"{'what':16} {'size':>9} {'MB':>7} {'best [s]':>9} {'median [s]':>11} {'limit [s]':>10}")
    for f in figures:
        print(
            f"{f.name:16} {f.size:9} {f.megabytes:7.1f} {f.best_s:9.3f} {f.median_s:11.3f} {f.limit_s:10.1f}"
        )
    if arguments.json:
        machine = {"python": sys.version.split()[0], "machine": platform.machine(), "cores": os.cpu_count()}
        content = {"machine": machine, "figures": [asdict(figure) for figure in figures]}
        arguments.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    return int(any(figure.median_s > figure.limit_s for figure in figures))


if __name__ == "__main__":
    sys.exit(main())
