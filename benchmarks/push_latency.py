# SPDX-License-Identifier: Apache-2.0
"""How long one push of a measurement takes, and one prediction: real logs pushed row by row, as on a robot.

A push is timed from Python, so that about a microsecond of each is the call itself. The mean is per pose, of
all pushes between two poses; where poses come less often than at 20 Hz, per twentieth of a second.

    python benchmarks/push_latency.py --only f1tenth --json latency.json
"""

from __future__ import annotations

import argparse
import gc
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from data_sets import DataSet, data_sets, input_names, required_folder
from numpy.typing import NDArray

import slipwise
from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import Settings
from slipwise.cli.output import Column, Output
from slipwise.cli.progress import progress_bar
from slipwise.logs import Log
from slipwise.segments import recording_rows

Floats = NDArray[np.float64]
Clock = Callable[[], int]  # ns

POSE_RATE = 20.0  # Hz
HORIZON = 5.0  # s
NO_FORCES = np.zeros((0, 3))
WANTED = {"command": 120.0, "wheel": 30.0}  # us per pose
BINS_PER_DECADE, BAR = 5, 30  # of histograms; characters of their longest bar


@dataclass(frozen=True, eq=False)
class Latency:
    """The pushes of one log."""

    log: str
    input: str
    pushes: Floats  # us each
    predictions: Floats  # us each
    per_pose: float  # us, mean

    def row(self) -> tuple[str, ...]:
        """Return the figures of a line of the table."""
        slow = 100.0 * float((self.pushes > 1000.0).mean())
        return (
            *(self.log, self.input, str(len(self.pushes)), f"{self.per_pose:.1f}"),
            *_quantiles(self.pushes),
            f"{slow:.3f}",
            f"{self.predictions.mean():.0f}",
            *_quantiles(self.predictions),
        )

    def as_dict(self) -> dict[str, Any]:
        """Return figures and histograms, for JSON."""
        kinds = {"pushes": self.pushes, "predictions": self.predictions}
        found = {
            name: {
                "count": len(us),
                "mean": float(us.mean()),
                "most": float(np.quantile(us, 0.999)),
                "longest": float(us.max()),
                "histogram": histogram(us),
            }
            for name, us in kinds.items()
        }
        return {"log": self.log, "input": self.input, "per_pose": self.per_pose, **found}


COLUMNS = (
    Column("log"),
    Column("input"),
    Column("pushes", True),
    Column("us/pose", True),
    Column("99.9 %", True),
    Column("longest", True),
    Column(">1ms %", True),
    Column("predict: mean", True),
    Column("99.9 %", True),
    Column("longest", True),
)


def _quantiles(us: Floats) -> tuple[str, str]:
    return f"{np.quantile(us, 0.999):.0f}", f"{us.max():.0f}"


def histogram(us: Floats) -> list[tuple[float, int]]:
    """Return upper edges of bins [us], evenly spaced in the logarithm up to the longest, and their counts."""
    last = int(np.ceil(BINS_PER_DECADE * np.log10(max(us.max(), 1.0)) - 1e-9))
    edges = 10.0 ** (np.arange(last + 1) / BINS_PER_DECADE)
    places = np.minimum(np.searchsorted(edges, us, side="left"), last)
    return list(zip(edges.tolist(), np.bincount(places, minlength=last + 1).tolist(), strict=True))


def show_histograms(output: Output, input_name: str, group: Sequence[Latency]) -> None:
    """Print how often pushes and predictions took how long, over all logs."""
    pushes = dict(histogram(np.concatenate([latency.pushes for latency in group])))
    predictions = dict(histogram(np.concatenate([latency.predictions for latency in group])))
    most = max(pushes.values())
    rows = []
    for edge in sorted(pushes | predictions):
        count = pushes.get(edge, 0)
        length = round(BAR * np.log1p(count) / np.log1p(most))
        rows.append((f"{edge:.1f}", str(count), "#" * length, str(predictions.get(edge, 0))))
    columns = (
        Column("up to us", True),
        Column("pushes", True),
        Column("(log scale)"),
        Column("predict", True),
    )
    output.table(f"From {input_name}s", columns, rows)


def pushed(log: Log, input_name: str, now: Clock) -> tuple[Floats, Floats, float]:
    """Push all rows; return the times of pushes and predictions [us], and the mean per pose [us]."""
    learner = _core.MotionLearner(core_settings(Settings(), input_name, (1.0, 2.0, 5.0)))
    push = {
        0: lambda row: learner.push_command(row[0], row[1], row[3], row[2]),
        1: lambda row: learner.push_wheels(row[0], row[1], row[3], row[2]),
        2: lambda row: learner.push_attitude(*row),
        3: lambda row: learner.push_pose(*row[:4], int(row[4])),
    }
    times, predictions, seconds, poses = [], [], 0.0, 0
    ahead = np.array([[0.0, 0.5, 0.0, 0.2]])
    for run in log.runs:
        learner.start_run()
        rows = [(row[0], kind, row.tolist()) for kind, rows in enumerate(recording_rows(run)) for row in rows]
        rows.sort(key=lambda row: (row[0], row[1]))
        seconds += rows[-1][0] - rows[0][0]
        poses += len(run.poses)
        for i, (t, kind, row) in enumerate(rows):
            begin = now()
            push[kind](row)
            times.append(now() - begin)
            if i % 200 == 199:
                ahead[0, 0] = t + 0.01
                begin = now()
                learner.predict(ahead, HORIZON, 0.0, NO_FORCES, None)
                predictions.append(now() - begin)
        learner.events()
    us = np.array(times) / 1000.0
    return us, np.array(predictions) / 1000.0, float(us.sum()) / max(poses, seconds * POSE_RATE)


def latency_of(data: DataSet, input_name: str, now: Clock) -> Latency:
    """Push one log."""
    gc.collect()
    gc.disable()
    pushes, predictions, per_pose = pushed(slipwise.open_log(data.path), input_name, now)
    gc.enable()
    return Latency(data.name, input_name, pushes, predictions, per_pose)


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    parser.add_argument("--json", type=Path, help="write all figures and histograms to this file too")
    parser.add_argument("--processor-time", action="store_true", help="where other work shares the machine")
    arguments = parser.parse_args()
    now = time.thread_time_ns if arguments.processor_time else time.perf_counter_ns
    folder = required_folder()
    chosen = [data for data in data_sets(folder) if arguments.only in data.name]
    found: list[Latency] = []
    with progress_bar("pushing") as progress:
        for k, data in enumerate(chosen):
            found += [latency_of(data, name, now) for name in input_names(slipwise.open_log(data.path))]
            progress(data.name[:24], (k + 1) / len(chosen))
    output = Output(arguments.json)
    output.table("Times of pushes and predictions [us]", COLUMNS, [latency.row() for latency in found])
    for input_name, wanted in WANTED.items():
        group = [latency for latency in found if latency.input == input_name]
        if group:
            show_histograms(output, input_name, group)
            pushes = np.concatenate([latency.pushes for latency in group])
            worst = max(latency.per_pose for latency in group)
            output.line(
                f"{input_name}: worst mean {worst:.0f} us per pose (wanted {wanted:.0f}), 99.9 % of pushes "
                f"within {np.quantile(pushes, 0.999):.0f} us (1000), longest {pushes.max():.0f} us (5000)"
            )
    output.document({"logs": [latency.as_dict() for latency in found]})
    return 0


if __name__ == "__main__":
    sys.exit(main())
