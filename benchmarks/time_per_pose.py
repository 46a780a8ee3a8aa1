# SPDX-License-Identifier: Apache-2.0
"""What learning live costs: processor time for each pose of 20 Hz, and the longest wait for a window.

Every real log is learned by `auto` with each input that it has, window after window as on a robot, with all
that goes on beside it: change of ground, structures, the search for limits, wandering slip and start pose.
All logs are gone through several times, and the fastest time of each counts: it is the least disturbed.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # idle threads would count as work

import argparse
import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from data_sets import DataSet, data_folder, data_sets, input_names
from slipwise.calibration.learning_run import start_learning

import slipwise
from slipwise.calibration import Settings
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.drive import prepare_drive

POSE_RATE = 20.0  # Hz
LIMIT = 200.0  # us of processor time for a pose
SHORTEST = 60.0  # s of driving from which a log counts: before, the first searches and fits weigh too much


@dataclass(frozen=True)
class PoseCost:
    """What one log cost with one input."""

    log: str
    input: str
    driven: float  # s
    windows: int
    microseconds: float  # for each pose of 20 Hz
    median_window: float  # ms
    longest_window: float  # ms


def measure(data: DataSet) -> list[PoseCost]:
    """Learn one log with every input that it has."""
    log = slipwise.open_log(data.path)
    settings = Settings()
    costs = []
    for name in input_names(log):
        windows = learning_windows(prepare_drive(log, name), name, settings)
        learning = start_learning(settings, name, windows)
        spent = np.empty(len(windows))
        for i in range(len(windows)):
            start = time.process_time()
            learning.belief(i + 1)
            spent[i] = time.process_time() - start
        driven = float((windows.end - windows.start).sum())
        each = spent.sum() / (driven * POSE_RATE)
        median, longest = float(np.median(spent)), float(spent.max())
        costs.append(PoseCost(data.name, name, driven, len(windows), 1e6 * each, 1e3 * median, 1e3 * longest))
    return costs


def summary(costs: list[PoseCost], name: str) -> str:
    """Say how many logs of one input keep to the limit."""
    found = np.array([cost.microseconds for cost in costs if cost.input == name and cost.driven >= SHORTEST])
    return (
        f"{name:8s} {len(found)} logs of at least {SHORTEST:g} s: median {np.median(found):.0f} us, most "
        f"{found.max():.0f} us; {(found <= LIMIT).sum()} within {LIMIT:g} us"
    )


def main() -> None:
    """Learn all logs, one after the other on one core, and print what they cost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures here")
    parser.add_argument("--rounds", type=int, default=5, help="how often all logs are gone through")
    options = parser.parse_args()
    folder = data_folder()
    if folder is None:
        parser.error("set SLIPWISE_DATA to the folder of the real logs")
    rounds = [[cost for data in data_sets(folder) for cost in measure(data)] for _ in range(options.rounds)]
    costs = [min(same, key=lambda cost: cost.microseconds) for same in zip(*rounds, strict=True)]
    print(f"{'log':40s} {'input':8s} {'driven [s]':>10s} {'us/pose':>8s}  window [ms]: median  longest")
    for cost in costs:
        print(
            f"{cost.log:40s} {cost.input:8s} {cost.driven:10.0f} {cost.microseconds:8.0f} "
            f"{cost.median_window:20.1f} {cost.longest_window:8.0f}"
        )
    print()
    for name in ("wheel", "command"):
        print(summary(costs, name))
    if options.json:
        options.json.write_text(
            json.dumps([asdict(cost) for cost in costs], indent=1) + "\n", encoding="utf-8"
        )


if __name__ == "__main__":
    main()
