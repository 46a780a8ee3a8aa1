# SPDX-License-Identifier: Apache-2.0
"""Is the covariance of the parameters true, also where slip is correlated in time? Exits 1 where it is not.

Robots with known slip (`disturbed_robot`) are learned with default settings from wheel speeds and from
commands alone, over logs of 2, 5 and 15 minutes. The slip rates at nine speeds are held against the truth:
where slip is disturbed slowly, at least 90 % lie within two reported standard deviations and at most 2 %
beyond three. Where noise is white, standard deviations are at most 1.3 times too wide.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

if __name__ == "__main__":  # run by its path as well as imported from the root
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np
from benchmarks.promises.disturbed_robot import Disturbance, DisturbedRun, Robot, disturbed_run
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration import calibrate
from slipwise.logs import Log
from slipwise.models import Model

Floats = NDArray[np.float64]

SPEEDS = tuple(itertools.product((0.4, 0.8, 1.2), (-0.5, 0.2, 0.6)))  # m/s, rad/s
MINUTES = (2.0, 5.0, 15.0)
INPUTS = ("wheel", "command")
NOISES = {"white": Disturbance(1.0, 0.0), "slow": Disturbance(0.0, 1.0), "both": Disturbance(0.5, 1.0)}
WITHIN_TWO, BEYOND_THREE = 0.90, 0.02
TOO_WIDE = 1.3  # times, where noise is white


@dataclass(frozen=True)
class Job:
    """One log to learn."""

    noise: str
    input: str
    minutes: float
    seed: int


@dataclass(frozen=True)
class Row:
    """How far slip rates were off, in reported standard deviations."""

    noise: str
    input: str
    minutes: str
    rms: float
    within_two: float
    beyond_three: float

    @property
    def kept(self) -> bool:
        """Whether that is what is promised."""
        if self.noise == "white":
            return self.rms >= 1.0 / TOO_WIDE and self.within_two >= WITHIN_TWO
        return self.within_two >= WITHIN_TWO and self.beyond_three <= BEYOND_THREE

    def __str__(self) -> str:
        return (
            f"{self.noise:6s} {self.input:8s} {self.minutes:>4s} min: rms {self.rms:.2f} "
            f"(NEES per rate {self.rms**2:.2f}), within two {100 * self.within_two:.1f} %, "
            f"beyond three {100 * self.beyond_three:.1f} %"
        )


def sigmas(job: Job) -> Floats:
    """Learn one log; return how far off each slip rate is, in reported standard deviations, [9, 3]."""
    robot = Robot(disturbance=NOISES[job.noise])
    run = disturbed_run(robot, job.minutes, seed=job.seed)
    log = run.log
    if job.input == "command":
        log = Log(tuple(replace(part, wheels=None) for part in log.runs))
    return judged(calibrate(log, input=job.input).model, run)


def judged(model: Model, run: DisturbedRun) -> Floats:
    """Hold the slip rates of a model against the truth."""
    motion, off = model.motion, np.empty((len(SPEEDS), 3))
    slips = motion.slip_size
    mean = np.ascontiguousarray(model.mean[:slips])
    covariance = np.asfortranarray(model.covariance[:slips, :slips])
    for i, (v, omega) in enumerate(SPEEDS):
        state = _core.SlipState(v, omega, 0.0, 0.0)
        variance = np.diag(_core.slip_rate_covariance(motion.basis, covariance, state))
        off[i] = (_core.slip_rate(motion.basis, mean, state) - run.rates(v, omega)) / np.sqrt(variance)
    return off


def measured_rows(jobs: Sequence[Job], workers: int) -> list[Row]:
    """Learn all logs; return one row per noise, input and length, and one over all lengths."""
    with ProcessPoolExecutor(workers) as pool:
        found = list(zip(jobs, pool.map(sigmas, jobs, chunksize=2), strict=True))
    rows = []
    for noise, name in dict.fromkeys((job.noise, job.input) for job in jobs):
        of_kind = [(job.minutes, off) for job, off in found if (job.noise, job.input) == (noise, name)]
        for minutes in (*sorted({length for length, _ in of_kind}), None):
            off = np.abs([each for length, each in of_kind if minutes in (length, None)])
            label = "all" if minutes is None else f"{minutes:g}"
            rms = float(np.sqrt(np.mean(off**2)))
            rows.append(Row(noise, name, label, rms, float(np.mean(off < 2.0)), float(np.mean(off > 3.0))))
    return rows


def main() -> int:
    """Print the table; return 1 where a promise is broken over all lengths."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--noise", choices=tuple(NOISES), nargs="+", default=list(NOISES))
    options = parser.parse_args()
    kinds = itertools.product(options.noise, INPUTS, MINUTES, range(options.seeds))
    rows = measured_rows([Job(*kind) for kind in kinds], options.workers)
    for row in rows:
        print(row, "" if row.kept or row.minutes != "all" else "  BROKEN")
    return 0 if all(row.kept for row in rows if row.minutes == "all") else 1


if __name__ == "__main__":
    sys.exit(main())
