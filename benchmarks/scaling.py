# SPDX-License-Identifier: Apache-2.0
"""Cost against log length: time and peak memory of opening, learning and judging 1 to 1000 minutes."""

from __future__ import annotations

import argparse
import itertools
import json
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray
from simulated_log import simulated_log

import slipwise
from slipwise.logs import Inputs, Log, Poses, save_log

MINUTES = (1, 10, 100, 1000)
METHODS = ("none", "auto")
INPUT = "wheel"


@dataclass(frozen=True)
class Cost:
    """What one log cost, in a process of its own."""

    minutes: float
    file_megabytes: float
    log_megabytes: float  # the arrays of the log in memory
    open_s: float
    calibrate_s: float
    evaluate_s: float
    open_cpu_s: float  # processor time of all threads, which other work on the machine disturbs less
    calibrate_cpu_s: float
    evaluate_cpu_s: float
    import_megabytes: float  # resident after importing slipwise, before anything is opened
    open_megabytes: float  # peak resident memory so far, each
    calibrate_megabytes: float
    evaluate_megabytes: float


def measure(path: Path, minutes: float) -> Cost:
    """Open, calibrate and evaluate one log in this process."""
    walls, processors, peaks = [time.perf_counter()], [time.process_time()], [peak_megabytes()]

    def mark() -> None:
        walls.append(time.perf_counter())
        processors.append(time.process_time())
        peaks.append(peak_megabytes())

    log = slipwise.open_log(path)
    mark()
    slipwise.calibrate(log, input=INPUT)
    mark()
    slipwise.evaluate(log, input=INPUT, options=slipwise.EvaluationOptions(methods=METHODS))
    mark()
    times = [after - before for marks in (walls, processors) for before, after in itertools.pairwise(marks)]
    return Cost(minutes, path.stat().st_size / 1e6, log_megabytes(log), *times, *peaks)


def peak_megabytes() -> float:
    """Return the largest resident memory of this process so far.

    Linux's VmHWM starts anew with the program; ru_maxrss, the fallback, also counts its parent process.
    """
    status = Path("/proc/self/status")
    if status.exists():
        lines = status.read_text(encoding="ascii", errors="replace").splitlines()
        return float(next(line for line in lines if line.startswith("VmHWM")).split()[1]) * 1024 / 1e6
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6


def log_megabytes(log: Log) -> float:
    """Return the size of all arrays of the log."""
    size = 0
    for run in log.runs:
        for series in (run.commands, run.wheels, run.poses):
            if series is not None:
                size += sum(array.nbytes for array in _arrays(series))
    return size / 1e6


def _arrays(series: Inputs | Poses) -> list[NDArray[Any]]:
    if isinstance(series, Inputs):
        return [series.t, series.v, series.vy, series.omega]
    optional = [array for array in series.optional().values() if array is not None]
    return [series.t, series.x, series.y, series.yaw, series.frame, *optional]


def measure_apart(path: Path, minutes: float) -> Cost:
    """Measure one log in a fresh process, so that its peak memory is its own."""
    command = [sys.executable, __file__, "--measure", str(path), "--minutes", str(minutes)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{minutes:g} minutes failed: {done.stderr.strip()[-800:]}")
    return Cost(**json.loads(done.stdout))


def print_costs(costs: list[Cost]) -> None:
    """Print times, memory, and how both grow from one length to the next."""
    print("20 Hz, tidy CSV, wheel input; evaluate: " + ", ".join(METHODS) + " at 1, 2 and 5 s; wall time\n")
    print(
        " minutes      rows  open [s]  calibrate  evaluate  us per row"
        "  log [MB]  peak [MB]: import   open  calibrate  evaluate"
    )
    for c in costs:
        rows = c.minutes * 1200
        total = c.open_s + c.calibrate_s + c.evaluate_s
        print(
            f"{c.minutes:8g}{rows:10.0f}{c.open_s:10.3f}{c.calibrate_s:11.3f}{c.evaluate_s:10.3f}"
            f"{1e6 * total / rows:12.1f}{c.log_megabytes:10.2f}{c.import_megabytes:19.0f}"
            f"{c.open_megabytes:7.0f}{c.calibrate_megabytes:11.0f}{c.evaluate_megabytes:10.0f}"
        )
    print(
        "\nGrowth of processor time from one length to the next (linear: as the length, less where start-up "
        "counts),\nand of peak memory beside the inflation of the log in memory:"
    )
    for short, long in itertools.pairwise(costs):
        print(
            f"  {short.minutes:g} -> {long.minutes:g} min, {long.minutes / short.minutes:g} x: open "
            f"{long.open_cpu_s / short.open_cpu_s:.1f} x, "
            f"calibrate {long.calibrate_cpu_s / short.calibrate_cpu_s:.1f} x, "
            f"evaluate {long.evaluate_cpu_s / short.evaluate_cpu_s:.1f} x; memory "
            f"{long.evaluate_megabytes - short.evaluate_megabytes:.0f} MB more for "
            f"{long.log_megabytes - short.log_megabytes:.1f} MB more of log"
        )


def main() -> int:
    """Run the benchmark, or measure one file for it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument("--quick", action="store_true", help="leave out the longest log")
    parser.add_argument("--measure", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--minutes", type=float, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        print(json.dumps(asdict(measure(arguments.measure, arguments.minutes))))
        return 0
    costs = []
    with tempfile.TemporaryDirectory() as name:
        for minutes in MINUTES[:-1] if arguments.quick else MINUTES:
            path = Path(name) / f"{minutes}.csv"
            save_log(simulated_log(minutes, seed=minutes), path)
            costs.append(measure_apart(path, minutes))
            path.unlink()
    print_costs(costs)
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(c) for c in costs], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
