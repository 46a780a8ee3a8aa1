# SPDX-License-Identifier: Apache-2.0
"""Are limits of the actuator learned from commands and poses alone? Exits 1 where a promise is broken.

Robots with a dead band, a top speed and rates of acceleration and braking (`disturbed_robot`), and robots
without, are calibrated with default settings; their logs have no wheel speeds. A model with a good verdict
has a delay beyond three of its standard deviations in at most 1 of 100 (chance alone: 0.5); behind limits
that were found, lags and delays are within three in at least 97 of 100; robots without limits have none.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

if __name__ == "__main__":  # run by its path as well as imported from the root
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np
from benchmarks.promises.disturbed_robot import Disturbance, Limits, Robot, disturbed_run

from slipwise.calibration import calibrate
from slipwise.logs import Log
from slipwise.models import Model

LIMITS = {
    "limits": (Limits(0.08, 1.1, 0.8, 1.5), Limits(0.08, 0.6, 1.2, 2.0)),
    "speed only": (Limits(0.08, 1.1, 0.8, 1.5), Limits()),
    "none": (Limits(), Limits()),
}
NOISES = {
    "white": Disturbance(1.0, 0.0),
    "students": Disturbance(1.0, 0.0, degrees=4.0),
    "both": Disturbance(0.5, 1.0),
}
MINUTES = (2.0, 5.0, 15.0)
WITHIN_THREE = 0.97
MISLEADING = 0.01


@dataclass(frozen=True)
class Job:
    """One log to calibrate."""

    limits: str
    noise: str
    minutes: float
    seed: int

    @property
    def kind(self) -> str:
        """All but the seed."""
        return f"{self.limits}, {self.noise}, {self.minutes:g} min"


@dataclass(frozen=True)
class Outcome:
    """What came of it."""

    job: Job
    good: bool
    found: bool  # limits that are kept
    lags: tuple[float, ...]  # how far off, in standard deviations
    delays: tuple[float, ...]

    @property
    def misleads(self) -> bool:
        """Whether a good verdict stands beside a delay that is far off."""
        return self.good and max(map(abs, self.delays), default=0.0) > 3.0


def calibrated(job: Job) -> Outcome:
    """Calibrate one log and hold lags and delays against the truth."""
    robot = Robot(limits=LIMITS[job.limits], disturbance=NOISES[job.noise])
    log = disturbed_run(robot, job.minutes, seed=job.seed).log
    result = calibrate(Log(tuple(replace(run, wheels=None) for run in log.runs)), input="command")
    return Outcome(job, result.verdict.good, result.model.limits is not None, *_off(result.model, robot))


def _off(model: Model, robot: Robot) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """How far off lags and delays are; where a model has no lag, its delay stands for both."""
    known = {each.name: each for each in model.content.parameters}
    lags, delays = [], []
    for axis, lag, delay in zip(("v", "omega"), robot.lag, robot.delay, strict=True):
        if (found := known.get(f"log_time_constant_{axis}")) is not None:
            lags.append((found.value - float(np.log(lag))) / found.std)
        if (found := known.get(f"log_delay_{axis}")) is not None:
            delays.append((found.value - float(np.log(delay))) / found.std)
        if (found := known.get(f"delay_{axis}")) is not None:
            delays.append((found.value - lag - delay) / found.std)
    return tuple(lags), tuple(delays)


def holds(outcomes: list[Outcome]) -> bool:
    """Print a line for these; return whether the promises hold."""
    behind = [abs(off) for each in outcomes if each.found for off in (*each.lags, *each.delays)]
    within = float(np.mean([off <= 3.0 for off in behind])) if behind else 1.0
    misleading = sum(each.misleads for each in outcomes)
    false = sum(each.found for each in outcomes if each.job.limits == "none")
    print(
        f"{len(outcomes)} robots, limits kept {sum(o.found for o in outcomes)} ({false} of them false), "
        f"good {sum(each.good for each in outcomes)}, good with a delay beyond three sigma {misleading}, "
        f"lags and delays behind limits within three {100 * within:.1f} %",
        flush=True,
    )
    return within >= WITHIN_THREE and misleading <= MISLEADING * len(outcomes) and false == 0


def main() -> int:
    """Print a line per kind of robot and log, and one over all; return 1 where a promise is broken."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    kinds = itertools.product(LIMITS, NOISES, MINUTES, range(options.seeds))
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(options.workers) as pool:
        found = pool.map(calibrated, [Job(*kind) for kind in kinds])
        for kind, group in itertools.groupby(found, lambda each: each.job.kind):
            outcomes += (members := list(group))
            print(f"{kind:24s}", end=" ")
            holds(members)
    print(f"{'all':24s}", end=" ")
    return 0 if holds(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
