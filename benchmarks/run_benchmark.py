# SPDX-License-Identifier: Apache-2.0
"""Runs all benchmarks one after the other and writes benchmarks/reports/<date>/REPORT.md."""

from __future__ import annotations

import argparse
import datetime as dt
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from data_sets import data_folder
from provenance import provenance
from report import Section, write_report

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Benchmark:
    """A script of this folder."""

    name: str
    title: str
    options: tuple[str, ...] = ()
    quick: tuple[str, ...] = ()  # options of a quick run
    has_figures: bool = True  # takes --json
    needs_data: bool = False


BENCHMARKS = (
    Benchmark("benchmark_logs", "Opening logs", quick=("--repeats", "1")),
    Benchmark("kernel", "The kernel, timed in C++", has_figures=False),
    Benchmark("filter_speed", "The filter beside numpy and filterpy", quick=("--quick",)),
    Benchmark("rollout", "Rollouts for planners, beside rivals", quick=("--quick",)),
    Benchmark("consistency", "Consistency of the reported uncertainty", quick=("--runs", "10")),
    Benchmark(
        "actuator_truth",
        "Is the truth found, and its uncertainty true?",
        quick=("--runs", "10", "--physics", "1"),
        has_figures=False,
    ),
    Benchmark("real_logs", "The score on real logs", needs_data=True),
    Benchmark("file_coverage", "Ellipsoids from a model file", has_figures=False, needs_data=True),
    Benchmark("terrain_change", "Finding a change of terrain", quick=("--quick",)),
    Benchmark("convergence", "Seconds of driving until the model has converged", needs_data=True),
    Benchmark("push_latency", "Time per push and per prediction, live", needs_data=True),
    Benchmark("day_of_driving", "Memory and time over a day of driving", quick=("--hours", "2")),
    Benchmark(
        "ablation",
        "Every mechanism on and off",
        quick=("--only", "f1tenth/DS4", "--mechanism", "structure"),
        needs_data=True,
    ),
    Benchmark(
        "sensitivity",
        "How much each constant matters",
        quick=("--only", "f1tenth/DS4", "--constant", "weighting"),
        needs_data=True,
    ),
    Benchmark(
        "promises/terrain_change",
        "A change of terrain is found, or forgotten",
        quick=("--seeds", "1"),
        has_figures=False,
    ),
    Benchmark(
        "promises/covariance",
        "Covariances where slip is correlated in time",
        quick=("--seeds", "4"),
        has_figures=False,
    ),
    Benchmark(
        "promises/limits_from_poses",
        "Limits of the actuator from commands and poses alone",
        quick=("--seeds", "1"),
        has_figures=False,
    ),
    Benchmark("surfaces", "Slip surfaces: time and held-out scores", quick=("--quick",)),
    Benchmark("slalom", "A slalom by MPPI: plain, vendor and learned model", quick=("--quick",)),
    Benchmark("scaling", "Cost against log length", quick=("--quick",)),
)


def run(benchmark: Benchmark, folder: Path, *, quick: bool) -> Section:
    """Run one benchmark in a process of its own, showing its output as well as keeping it."""
    chosen = benchmark.quick if quick and benchmark.quick else benchmark.options
    raw = f"{benchmark.name}.json" if benchmark.has_figures else None
    output_option = ["--json", str(folder / raw)] if raw else []
    command = [sys.executable, str(HERE / f"{benchmark.name}.py"), *chosen, *output_option]
    print(f"\n## {benchmark.title}\n", flush=True)
    start, lines = time.perf_counter(), []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout or ():
            print(line, end="", flush=True)
            lines.append(line)
    return Section(
        title=benchmark.title,
        command=" ".join(["python", f"benchmarks/{benchmark.name}.py", *chosen]),
        seconds=time.perf_counter() - start,
        output="".join(lines),
        failed=process.returncode != 0,
        raw=raw if raw and (folder / raw).exists() else None,
    )


def chosen_benchmarks(only: str | None) -> list[Benchmark]:
    """Return the benchmarks to run; those of real logs are passed over where there are none."""
    chosen = [b for b in BENCHMARKS if only in (None, b.name)]
    for benchmark in chosen:
        if benchmark.needs_data and data_folder() is None:
            print(f"{benchmark.name} is passed over: SLIPWISE_DATA names no folder of real logs")
    return [b for b in chosen if not b.needs_data or data_folder() is not None]


def main() -> int:
    """Run the benchmarks; exit code 1 if one failed or missed a limit of its own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=[b.name for b in BENCHMARKS], help="run this one alone")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, to see that all works")
    parser.add_argument("--output", type=Path, help="folder of the report, instead of reports/<date>")
    arguments = parser.parse_args()
    today = dt.datetime.now(tz=dt.UTC).date().isoformat()
    folder = (arguments.output or HERE / "reports" / today).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    before = os.getloadavg()[0]
    machine = provenance(data_folder())
    sections = [run(b, folder, quick=arguments.quick) for b in chosen_benchmarks(arguments.only)]
    path = write_report(folder, machine, sections, (before, os.getloadavg()[0]))
    print(f"\nWrote {os.path.relpath(path)}")
    failed = [section.title for section in sections if section.failed]
    if failed:
        print("Failed: " + ", ".join(failed))
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
