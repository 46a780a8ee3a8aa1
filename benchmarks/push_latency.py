# SPDX-License-Identifier: Apache-2.0
"""How long one push of a measurement takes, and one prediction: real logs pushed row by row, as on a robot.

A push is timed from Python, so that about a microsecond of each is the call itself. The mean is per pose, of
all pushes between two poses; where poses come less often than at 20 Hz, per twentieth of a second.
"""

from __future__ import annotations

import argparse
import gc
import sys
import time
from dataclasses import dataclass

import numpy as np
from data_sets import DataSet, data_folder, data_sets, input_names
from numpy.typing import NDArray

import slipwise
from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.settings import Settings
from slipwise.logs import Log
from slipwise.segments import recording_rows

POSE_RATE = 20.0  # Hz
HORIZON = 5.0  # s
WANTED = {"command": 120.0, "wheel": 30.0}  # us per pose


@dataclass(frozen=True, eq=False)
class Latency:
    """The pushes of one log."""

    name: str
    pushes: NDArray[np.float64]  # us each
    predictions: NDArray[np.float64]  # us each
    per_pose: float  # us, mean

    def row(self) -> str:
        """Return the figures on one line."""
        p = self.pushes
        slow = 100.0 * float((p > 1000.0).mean())
        predicted = f"{np.median(self.predictions):6.0f} {self.predictions.max():6.0f}"
        return (
            f"{self.name:44} {len(p):7d} {self.per_pose:8.1f} {np.quantile(p, 0.999):8.0f} {p.max():8.0f} "
            f"{slow:7.3f} {predicted}"
        )


def pushed(log: Log, input_name: str) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
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
            begin = time.perf_counter_ns()
            push[kind](row)
            times.append(time.perf_counter_ns() - begin)
            if i % 200 == 199:
                ahead[0, 0] = t + 0.01
                begin = time.perf_counter_ns()
                learner.predict(ahead, HORIZON, 0.0)
                predictions.append(time.perf_counter_ns() - begin)
        learner.events()
    us = np.array(times) / 1000.0
    return us, np.array(predictions) / 1000.0, float(us.sum()) / max(poses, seconds * POSE_RATE)


def latency_of(data: DataSet, input_name: str) -> Latency:
    """Push one log."""
    gc.collect()
    gc.disable()
    pushes, predictions, per_pose = pushed(slipwise.open_log(data.path), input_name)
    gc.enable()
    return Latency(f"{data.name} {input_name}", pushes, predictions, per_pose)


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    arguments = parser.parse_args()
    folder = data_folder()
    if folder is None:
        print("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
        return 2
    print(
        f"{'log':44} {'pushes':>7} {'us/pose':>8} {'99.9 %':>8} {'longest':>8} {'>1ms %':>7} "
        "predict: median, longest us"
    )
    found = []
    for data in (data for data in data_sets(folder) if arguments.only in data.name):
        for input_name in input_names(slipwise.open_log(data.path)):
            found.append((input_name, latency_of(data, input_name)))
            print(found[-1][1].row(), flush=True)
    for input_name, wanted in WANTED.items():
        group = [latency for name, latency in found if name == input_name]
        if group:
            pushes = np.concatenate([latency.pushes for latency in group])
            worst = max(latency.per_pose for latency in group)
            print(
                f"{input_name}: worst mean {worst:.0f} us per pose (wanted {wanted:.0f}), 99.9 % of pushes "
                f"within {np.quantile(pushes, 0.999):.0f} us (1000), longest {pushes.max():.0f} us (5000)"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
