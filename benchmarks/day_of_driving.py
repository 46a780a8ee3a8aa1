# SPDX-License-Identifier: Apache-2.0
"""A day of driving pushed through the learner: is memory flat, and does a push take as long at the end?

The robot is simulated (`driven_day`): commands at 100 Hz, wheel speeds at 50 Hz, poses at 20 Hz, delay, lag,
slip noise. Resident memory is sampled every ten simulated minutes. The learner keeps its last 4096
predictions of each horizon, which are complete after 5.7 h; from then on memory is flat where a line through
the samples rises by less than a megabyte a day. Exits 1 where it is not. Times are processor times. In the
first and the last hour single pushes are timed; these samples do not count, since that takes memory too.

    python benchmarks/day_of_driving.py --hours 2 --json day.json
"""

from __future__ import annotations

import argparse
import gc
import resource
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from driven_day import COMMANDS, POSES, WHEELS, DrivenDay, Measured
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import Settings
from slipwise.cli.output import Column, Output
from slipwise.cli.progress import Update, progress_bar

Floats = NDArray[np.float64]

EVERY = 600.0  # s between samples
FIRST, FULL = 3600.0, 6.0 * 3600.0  # s: the first hour; by when all that is kept is complete
FLAT = 1e6 / 24.0  # bytes per hour
SEED = 24
HORIZONS = (1.0, 2.0, 5.0)


@dataclass(frozen=True)
class Sample:
    """Ten minutes of driving."""

    until: float  # s of the simulation
    resident: int  # bytes afterwards
    per_push: float  # us of processor time, mean
    timed: bool = False  # single pushes were, which takes memory of its own


@dataclass(frozen=True)
class Hour:
    """Single pushes of an hour, timed from Python [us of processor time]."""

    name: str
    pushes: int
    mean: float
    most: float  # 99.9 %
    longest: float


@dataclass(frozen=True)
class Day:
    """What was measured."""

    samples: tuple[Sample, ...]
    hours: tuple[Hour, ...]

    def slope(self, since: float) -> tuple[float, float]:
        """Bytes per hour from `since` [s] on, and their standard error; NaN for few samples."""
        later = [s for s in self.samples if s.until >= since and not s.timed]
        if len(later) < 3:
            return float("nan"), float("nan")
        t = np.array([s.until for s in later]) / 3600.0
        resident = np.array([s.resident for s in later], dtype=np.float64)
        centred = t - t.mean()
        slope = float(centred @ resident / (centred @ centred))
        left = resident - resident.mean() - slope * centred
        return slope, float(np.sqrt(left @ left / (len(t) - 2) / (centred @ centred)))

    @property
    def flat(self) -> bool | None:
        """Whether memory does not grow once all that is kept is complete; None where the day is too short."""
        slope, _ = self.slope(FULL)
        return None if np.isnan(slope) else bool(slope < FLAT)


def resident_bytes() -> int:
    """Return how much memory this process has in use now; where only the most so far is known, that."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text(encoding="ascii").split()[1]) * resource.getpagesize()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def drive(hours: float, input_name: str, progress: Update) -> Day:
    """Drive and learn; the first and the last hour are pushed row by row, what is between in pieces."""
    learner = _core.MotionLearner(core_settings(Settings(), input_name, HORIZONS))
    robot, samples = DrivenDay(SEED), []
    timed: dict[str, list[Floats]] = {"first": [], "last": []}
    learner.start_run()
    seconds = hours * 3600.0
    for k in range(round(seconds / EVERY)):
        measured = robot.next(EVERY)
        until = (k + 1) * EVERY
        hour = "first" if until <= 3600.0 else "last" if until > seconds - 3600.0 else None
        begin = time.process_time()
        if hour is None:
            learner.push(measured.recording())
        else:
            timed[hour].append(pushed_one_by_one(learner, measured))
        spent = time.process_time() - begin
        learner.events()
        del measured
        gc.collect()
        pushes = EVERY * (COMMANDS + WHEELS + POSES)
        samples.append(Sample(until, resident_bytes(), 1e6 * spent / pushes, timed=hour is not None))
        progress(f"{until / 3600.0:.1f} h", until / seconds)
    return Day(tuple(samples), tuple(_hour(name, parts) for name, parts in timed.items() if parts))


def pushed_one_by_one(learner: _core.MotionLearner, measured: Measured) -> Floats:
    """Push all rows in the order of their stamps; return how long each took [us]."""
    push: dict[int, Callable[[list[float]], None]] = {
        0: lambda row: learner.push_command(row[0], row[1], row[3], row[2]),
        1: lambda row: learner.push_wheels(row[0], row[1], row[3], row[2]),
        2: lambda row: learner.push_pose(*row[:4], int(row[4])),
    }
    streams = (measured.commands, measured.wheels, measured.poses)
    stamps = np.concatenate([rows[:, 0] for rows in streams])
    kinds = np.repeat(np.arange(3), [len(rows) for rows in streams])
    places = np.concatenate([np.arange(len(rows)) for rows in streams])
    times = np.empty(len(stamps))
    for n, i in enumerate(np.lexsort((kinds, stamps)).tolist()):
        kind = int(kinds[i])
        row = streams[kind][places[i]].tolist()
        begin = time.thread_time_ns()
        push[kind](row)
        times[n] = time.thread_time_ns() - begin
    return times / 1000.0


def _hour(name: str, parts: Sequence[Floats]) -> Hour:
    us = np.concatenate(parts)
    return Hour(name, len(us), float(us.mean()), float(np.quantile(us, 0.999)), float(us.max()))


def show(output: Output, day: Day) -> None:
    """Print one line an hour, the pushes, and whether memory is flat."""
    shown = [s for s in day.samples if s.until % 3600.0 == 0.0] or list(day.samples)
    rows = [(f"{s.until / 3600.0:.1f}", f"{s.resident / 1e6:.3f}", f"{s.per_push:.2f}") for s in shown]
    columns = (Column("hours", True), Column("resident [MB]", True), Column("us per push", True))
    output.table("Memory and time, in ten minutes up to then", columns, rows)
    columns = (
        Column("hour"),
        Column("pushes", True),
        Column("mean [us]", True),
        Column("99.9 %", True),
        Column("longest", True),
    )
    rows = [(h.name, str(h.pushes), f"{h.mean:.2f}", f"{h.most:.0f}", f"{h.longest:.0f}") for h in day.hours]
    output.table("Single pushes, from Python", columns, rows)
    for since in (FIRST, FULL):
        slope, error = day.slope(since)
        if not np.isnan(slope):
            output.line(f"From hour {since / 3600.0:g} on: {slope:+.0f} +- {error:.0f} bytes per hour")
    said = {True: "flat", False: "NOT FLAT", None: "not judged: that takes 7 hours and more"}
    output.line(f"Resident memory is {said[day.flat]}.")


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--hours", type=float, default=24.0, help="of driving, 2 or more")
    parser.add_argument(
        "--only", choices=("command", "wheel"), default="command", help="what motion is learned from"
    )
    parser.add_argument("--json", type=Path, help="write all samples to this file too")
    arguments = parser.parse_args()
    if arguments.hours < 2.0:
        print("the first and the last hour are timed apart: --hours takes 2 or more")
        return 2
    with progress_bar("driving") as progress:
        day = drive(arguments.hours, arguments.only, progress)
    output = Output(arguments.json)
    show(output, day)
    output.document(asdict(day) | {"bytes_per_hour": day.slope(FULL), "flat": day.flat})
    return int(day.flat is False)


if __name__ == "__main__":
    sys.exit(main())
