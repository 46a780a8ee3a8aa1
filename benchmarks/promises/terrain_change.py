# SPDX-License-Identifier: Apache-2.0
"""Is a change of terrain found, or at least forgotten? Exits 1 where it is not.

After 300 s, the yaw slip of simulated robots (`disturbed_robot`) is multiplied by 0.5, 0.75 or 1.5.
Slip noise is Student distributed, with a slowly varying part, and of two magnitudes. From wheel
speeds and from commands alone, predictions over 5 s that start 30 to 150 s after the step are held
against those of a learner that has had the new terrain for the whole time, over the same commands
and the same noise. Their mean heading errors may be 1.15 times as large in the geometric mean, and
1.5 times at most. On terrain that stays, at most one alarm per 1000 segments is raised, and what
watches for changes costs at most 1 % of heading error.
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
from benchmarks.promises.disturbed_robot import Disturbance, Robot, TerrainChange, disturbed_run

from slipwise.calibration.learned import Learned
from slipwise.calibration.learned_log import Keep, learn_log
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Log

STEP_AT, JUDGED = 300.0, (330.0, 450.0)  # s
MINUTES, HORIZON = 7.6, 5.0  # min, s
FACTORS = (0.5, 0.75, 1.5)
INPUTS = ("wheel", "command")
MEAN, WORST = 1.15, 1.5  # times the heading error of a learner of the new terrain alone
ALARMS, LOSS = 1.0, 1.01  # alarms per 1000 segments; times the heading error without branches
NOISES = {"0.05": 0.7, "0.026": 0.32}  # mean heading error at 5 s [rad]: factor of white slip
SLOW, DEGREES, CLOCK_OFFSET = 0.08, 4.0, 0.02


@dataclass(frozen=True)
class Job:
    """One robot that meets a change of terrain."""

    noise: str
    input: str
    factor: float
    seed: int


@dataclass(frozen=True)
class Found:
    """Mean heading errors of 5 s predictions [rad], and alarms."""

    after: float
    reference: float
    delay: float | None  # s from the step to the first alarm
    same: float  # on the new terrain for the whole time
    unwatched: float  # the same without looking for changes
    segments: int
    alarms: int

    @property
    def ratio(self) -> float:
        """How much worse than a learner that has known the new terrain alone."""
        return self.after / self.reference


def judge(job: Job) -> Found:
    """Learn the changing and the unchanging log of one robot."""
    noise = NOISES[job.noise]
    robot = Robot(clock_offset=CLOCK_OFFSET, disturbance=Disturbance(noise, SLOW, DEGREES))
    settings = Settings()
    unwatched = Settings.model_validate({"change": {"branches": False}})
    changed = _learned(robot, job, STEP_AT, settings)
    always = _learned(robot, job, 0.0, settings)
    plain = _learned(robot, job, 0.0, unwatched)
    alarms = _alarms(changed)
    late = alarms[alarms > STEP_AT]
    before = _alarms(always)
    return Found(
        after=_heading(changed, *JUDGED),
        reference=_heading(always, *JUDGED),
        delay=float(late[0] - STEP_AT) if len(late) else None,
        same=_heading(always, 0.0, JUDGED[1]),
        unwatched=_heading(plain, 0.0, JUDGED[1]),
        segments=0 if always.history is None else len(always.history.t),
        alarms=len(before),
    )


def _learned(robot: Robot, job: Job, at: float, settings: Settings) -> Learned:
    change = TerrainChange(at, job.factor)
    log = disturbed_run(robot, MINUTES, seed=job.seed, change=change).log
    if job.input == "command":
        log = Log(tuple(replace(part, wheels=None) for part in log.runs))
    return learn_log(prepare_run(log, job.input), settings, (HORIZON,), keep=Keep(settings.wheel_separation))


def _alarms(learned: Learned) -> np.ndarray:
    history = learned.history
    return np.empty(0) if history is None else history.t[history.alarm]


def _heading(learned: Learned, first: float, last: float) -> float:
    predictions = learned.predictions[0]
    judged = (predictions.t_start >= first) & (predictions.t_start <= last)
    return float(predictions.heading_error[judged].mean())


def geometric_mean(ratios: list[float]) -> float:
    """Return the geometric mean."""
    return float(np.exp(np.mean(np.log(ratios))))


def kept(found: list[Found]) -> bool:
    """Whether that is what is promised."""
    ratios = [each.ratio for each in found]
    per_thousand = 1000.0 * sum(each.alarms for each in found) / sum(each.segments for each in found)
    loss = geometric_mean([each.same / each.unwatched for each in found])
    return geometric_mean(ratios) <= MEAN and max(ratios) <= WORST and per_thousand <= ALARMS and loss <= LOSS


def line(name: str, found: list[Found]) -> str:
    """Return one line of the table."""
    ratios = [each.ratio for each in found]
    delays = [each.delay for each in found if each.delay is not None]
    return (
        f"{name:24s} error {np.mean([each.reference for each in found]):.4f} rad on the new terrain alone; "
        f"after the step {geometric_mean(ratios):.3f} times (worst {max(ratios):.2f}), "
        f"alarm in {len(delays)} of {len(found)}{f' after {np.median(delays):.0f} s' if delays else ''}; "
        f"where it stays {sum(each.alarms for each in found)} alarms in "
        f"{sum(each.segments for each in found)} segments, "
        f"{geometric_mean([each.same / each.unwatched for each in found]):.3f} times"
    )


def main() -> int:
    """Print the table; return 1 where the promise is broken."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = [Job(*kind) for kind in itertools.product(NOISES, INPUTS, FACTORS, range(options.seeds))]
    with ProcessPoolExecutor(options.workers) as pool:
        found = dict(zip(jobs, pool.map(judge, jobs), strict=True))
    for kind in itertools.product(NOISES, INPUTS, FACTORS):
        rows = [each for job, each in found.items() if (job.noise, job.input, job.factor) == kind]
        print(line(f"{kind[0]} {kind[1]} x{kind[2]}", rows))
    everything = list(found.values())
    print(line("all", everything), "" if kept(everything) else "  BROKEN")
    return 0 if kept(everything) else 1


if __name__ == "__main__":
    sys.exit(main())
