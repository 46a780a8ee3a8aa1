# SPDX-License-Identifier: Apache-2.0
"""Generates the logs of a large fleet: simulated drives and copies of real ones, no two with the same bytes.

    python benchmarks/fleet_logs.py FOLDER --logs 10000 --minutes 10

Every simulated vehicle has a slip of its own, drawn about what all have in common, and drives once a day.
Where SLIPWISE_DATA names the real logs, every other log is one of them, moved to another day.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from data_sets import data_folder, data_sets

from slipwise import _core
from slipwise.logs import Log, open_log, save_log
from slipwise.logs.log import Inputs, Poses, Run
from slipwise_sim import thesis_drive
from slipwise_sim.known_robot import KnownRobot, known_run

VEHICLES = 20  # simulated
DAY = 86400.0  # s
FIRST = 1.7e9  # s since 1970, of the first simulated day
BASIS = "edd-2"
MEAN, SPREAD = np.array([-0.15, -0.35]), np.array([0.02, 0.03])  # of the slip of vehicles

Series = TypeVar("Series", Inputs, Poses)


def simulated_log(vehicle: int, day: int, seconds: float) -> Log:
    """Return the drive of a vehicle on a day."""
    drawn = np.random.default_rng(vehicle).standard_normal(2)
    slip = tuple((MEAN + SPREAD * drawn).tolist())
    robot = KnownRobot(basis=_core.named_basis(BASIS), slip=slip)
    random = np.random.default_rng([vehicle, day])
    commands = thesis_drive(1 + int(random.integers(1 << 30)), seconds)
    return moved(Log((known_run(robot, commands, (0.0, seconds), random=random),)), FIRST + day * DAY)


def moved(log: Log, by: float) -> Log:
    """Return a log as it would have been so many seconds later, without columns that nothing reads."""
    return replace(log, runs=tuple(_moved(run, by) for run in log.runs))


def _moved(run: Run, by: float) -> Run:
    wheels = None if run.wheels is None else _later(run.wheels, by)
    commands = None if run.commands is None else _later(run.commands, by)
    return Run(run.name, commands, wheels, _later(run.poses, by))


def _later(series: Series, by: float) -> Series:
    return replace(series, t=series.t + by)


def write_logs(folder: Path, logs: int, seconds: float, real: Path | None) -> Iterator[Path]:
    """Write logs into a folder per vehicle and yield each path; every other is real where there are such."""
    known = [] if real is None else data_sets(real)
    opened: dict[str, Log] = {}
    for number in range(logs):
        place = number // 2 if known else number
        if known and number % 2:
            data = known[place % len(known)]
            if data.name not in opened:
                opened[data.name] = open_log(data.path)
            log = moved(opened[data.name], DAY * (1 + place // len(known)))
            path = folder / data.name.replace("/", "-") / f"{number:06d}.parquet"
        else:
            log = simulated_log(place % VEHICLES, place // VEHICLES, seconds)
            path = folder / f"simulated-{place % VEHICLES:02d}" / f"{number:06d}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        save_log(log, path)
        yield path


def main() -> int:
    """Write the logs that the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--logs", type=int, default=100)
    parser.add_argument("--minutes", type=float, default=10.0, help="of a simulated drive")
    asked = parser.parse_args()
    size = sum(
        path.stat().st_size
        for path in write_logs(asked.folder, asked.logs, 60.0 * asked.minutes, data_folder())
    )
    print(f"{asked.logs} logs, {size / 1e6:.0f} MB, in {asked.folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
