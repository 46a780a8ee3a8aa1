# SPDX-License-Identifier: Apache-2.0
"""What looking for moves worth driving costs `slipwise live`: the time from a sample to its odometry.

A node hears commands at 100 Hz, wheel speeds at 50 Hz and poses at 20 Hz in real time, without looking for
moves but once, every 10 s as a node does, and every second.

    python benchmarks/move_latency.py --seconds 60
"""

from __future__ import annotations

import argparse
import itertools
import math
import sys
import time
from collections.abc import Iterator

import numpy as np
from driven_day import DrivenDay
from live_node import EPOCH, SEED, samples_of

from slipwise.calibration import Settings
from slipwise.cli.output import Column, Output
from slipwise.live import move_adviser
from slipwise.live.build import build_node
from slipwise.live.feed import Feed
from slipwise.live.outputs import NextMovesNow, Odometry
from slipwise.live.outputs import Output as Given
from slipwise.live.samples import Sample

LEARNED = 120.0  # s of driving before time counts, as fast as it goes


class Robot(Feed):
    """Drives in real time after a while, and notes when a sample comes and when its odometry does."""

    def __init__(self, seconds: float) -> None:
        self.latencies: list[float] = []  # s
        self.looks = 0
        self._came: dict[float, float] = {}  # s of the clock by stamp
        super().__init__(self._drive(DrivenDay(SEED), seconds))

    def publish(self, output: Given) -> None:
        """Note when odometry comes."""
        if isinstance(output, Odometry) and output.t in self._came:
            self.latencies.append(time.monotonic() - self._came.pop(output.t))
        self.looks += isinstance(output, NextMovesNow)

    def _drive(self, day: DrivenDay, seconds: float) -> Iterator[Sample]:
        yield from samples_of(day.next(LEARNED))
        time.sleep(2.0)  # until all of it is learned
        begin = time.monotonic() - LEARNED
        for sample in itertools.chain.from_iterable(samples_of(day.next(10.0)) for _ in itertools.count()):
            t = sample.t  # type: ignore[union-attr]
            due = t - EPOCH
            if due > LEARNED + seconds:
                return
            time.sleep(max(0.0, begin + due - time.monotonic()))
            self._came.setdefault(t, time.monotonic())
            yield sample


def main() -> int:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=60.0, help="of each node")
    options = parser.parse_args()
    names = ("every [s]", "looks", "p50 [ms]", "p99 [ms]", "worst [ms]", "processor [%]")
    rows = []
    for every in (math.inf, 10.0, 1.0):  # the first: a look at the start alone
        robot = Robot(options.seconds)
        move_adviser.LOOK_EVERY = every
        node, used = build_node(robot, "command", Settings(), run="a drive").node, time.process_time()
        node.run()
        busy = 100.0 * (time.process_time() - used) / options.seconds  # the drive before it included
        p50, p99, worst = 1e3 * np.percentile(robot.latencies, (50, 99, 100))
        rows.append([f"{every:g}", str(robot.looks), *(f"{x:.2f}" for x in (p50, p99, worst)), f"{busy:.1f}"])
    Output(None).table("From a sample to its odometry", [Column(name, right=True) for name in names], rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
