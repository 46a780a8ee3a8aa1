# SPDX-License-Identifier: Apache-2.0
"""How soon a change of terrain is followed, and what is lost where there is none.

After 300 to 304 s, at five instants between windows in turn, the yaw slip of simulated robots
(`promises/disturbed_robot.py`) is multiplied by 0.5, 0.75 or 1.5, on smooth and rough ground and where slip
lasts for 5 s. Predictions over 5 s are held against those of a learner that is told of the change: at the
step its slip is forgotten; actuator, clock and noise are kept. One learner has branches that jump, as it
comes, one never changes (`change.branches`). Long drives over one ground, with slip that lasts for 5, 20 and
60 s, show what false changes cost.
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
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from benchmarks.promises.disturbed_robot import Disturbance, Robot, TerrainChange, disturbed_run
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.prepared_run import PreparedRun, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Log
from slipwise.segments import recording_of
from slipwise.student import fraction_inside

Floats = NDArray[np.float64]

STEP_AT, MINUTES, HORIZON, CLOCK_OFFSET = 300.0, 7.6, 5.0, 0.02  # s, min, s, s
INTERVALS = (  # s since the step; predictions from -5 to 0 straddle it
    *((-200.0, -5.0), (0.0, 5.0), (5.0, 10.0), (10.0, 15.0), (15.0, 20.0), (20.0, 30.0), (10.0, 30.0)),
    *((30.0, 60.0), (60.0, 151.0), (30.0, 151.0)),
)
WHOLE = (-240.0, 2000.0)  # s since the step
FACTORS = (0.5, 0.75, 1.5)
NOISES = {
    "smooth": Disturbance(white=0.2, slow=0.0, degrees=4.0),
    "rough": Disturbance(white=0.8, slow=0.0, degrees=4.0),
    "5 s": Disturbance(white=0.2, slow=0.5),
}
LASTING = (5.0, 20.0, 60.0)  # s
LEVELS = (0.5, 0.9, 0.95)


@dataclass(frozen=True)
class Job:
    """One drive and how it is learned."""

    noise: str
    input: str
    factor: float  # of yaw slip; 1: the ground stays
    seed: int
    learner: str
    embargo: float  # s
    minutes: float = MINUTES
    correlation_time: float = 5.0  # s
    step_at: float = STEP_AT  # s


@dataclass(frozen=True, eq=False)
class Found:
    """Predictions of one drive."""

    start: Floats  # s since the step
    position: Floats  # m, errors
    heading: Floats  # rad, errors
    inside: Floats  # the least probability of an ellipsoid that holds what was measured
    alarms: Floats  # s since the step


def settings_of(learner: str) -> Settings:
    """Return how a learner learns."""
    return Settings.model_validate({"change": {"branches": learner == "branches"}})


def drive_of(job: Job) -> tuple[PreparedRun, ...]:
    """Simulate the drive."""
    robot = Robot(
        clock_offset=CLOCK_OFFSET, disturbance=NOISES[job.noise], correlation_time=job.correlation_time
    )
    change = None if job.factor == 1.0 else TerrainChange(job.step_at, job.factor)
    log = disturbed_run(robot, job.minutes, seed=job.seed, change=change).log
    if job.input == "command":
        log = Log(tuple(replace(part, wheels=None) for part in log.runs))
    return prepare_run(log, job.input)


def learned(job: Job) -> Found:
    """Learn a drive as it comes."""
    (run,) = drive_of(job)
    core = core_settings(settings_of(job.learner), job.input, (HORIZON,))
    stream = core.stream
    stream.embargo = job.embargo
    core.stream = stream
    learner = _core.MotionLearner(core)
    learner.start_run()
    since = -np.inf
    if job.learner == "told" and job.factor != 1.0:
        since = _learn_until(learner, run, job.step_at)
        learner.forget(1.0)
    learner.push(recording_of(run.run, since, np.inf, ()))
    learner.end_run()
    events = [event for event in learner.events() if event.kind == _core.EventKind.TerrainChange]
    held_out = learner.model().held_out[0].columns()
    return found_of(held_out, np.array([event.t for event in events]), job.step_at)


def _learn_until(learner: _core.MotionLearner, run: PreparedRun, t: float) -> float:
    """Push a run until the segment that holds `t` is learned; return what was pushed up to [s]."""
    since, until, known = -np.inf, t, -np.inf
    while known < t and until < t + 10.0:
        learner.push(recording_of(run.run, since, until, ()))
        since, until = until, until + 0.1
        known = max([known, *(e.t for e in learner.events() if e.kind == _core.EventKind.SegmentLearned)])
    return since


def found_of(columns: _core.HeldOutColumns, alarms: Floats, step_at: float) -> Found:
    """Return the errors of held-out predictions."""
    left = columns.measured - columns.pose
    left[:, 2] = np.arctan2(np.sin(left[:, 2]), np.cos(left[:, 2]))
    covariance = columns.covariance.reshape(-1, 3, 3)
    squared = np.einsum("ni,nij,nj->n", left, np.linalg.inv(covariance), left)
    return Found(
        start=columns.start - step_at,
        position=np.hypot(left[:, 0], left[:, 1]),
        heading=np.abs(left[:, 2]),
        inside=fraction_inside(squared, columns.dof),
        alarms=alarms - step_at,
    )


def within(found: Sequence[Found], value: str, first: float, last: float) -> Floats:
    """Return what was found of predictions that start in an interval."""
    return np.concatenate(
        [getattr(each, value)[(each.start >= first) & (each.start < last)] for each in found]
    )


def geometric_mean(ratios: Sequence[float]) -> float:
    """Return the geometric mean."""
    return float(np.exp(np.mean(np.log(ratios))))


def ratios(found: dict[Job, Found], learner: str, value: str, since: tuple[float, float]) -> dict[str, float]:
    """Return errors of a learner in an interval over those of one that is told, by noise and step."""
    cells: dict[tuple[str, float], dict[str, list[Found]]] = {}
    for job, each in found.items():
        cells.setdefault((job.noise, job.factor), {}).setdefault(job.learner, []).append(each)
    return {
        f"{noise} x{factor}": float(
            within(learners[learner], value, *since).mean() / within(learners["told"], value, *since).mean()
        )
        for (noise, factor), learners in cells.items()
    }


def print_steps(found: dict[Job, Found], learners: Sequence[str], value: str) -> None:
    """Print a line for each noise and learner: geometric means over the steps."""
    print(f"{value:9s}{'s since the step':>19s}", *(f"{a:.0f} to {b:.0f}".rjust(11) for a, b in INTERVALS))
    for noise in (*NOISES, ""):
        for learner in learners:
            by_cell = [ratios(found, learner, value, since) for since in INTERVALS]
            means = [
                geometric_mean([ratio for cell, ratio in cells.items() if cell.startswith(noise)])
                for cells in by_cell
            ]
            print(f"{noise or 'all':9s}{learner:>19s}", *(f"{mean:11.2f}" for mean in means))


def print_coverage(found: dict[Job, Found], learners: Sequence[str]) -> None:
    """Print how much the 50, 90 and 95 % ellipsoids hold, and how often a change was announced."""
    for learner in learners:
        drives = [each for job, each in found.items() if job.learner == learner]
        inside = {
            when: [
                round(100.0 * float((within(drives, "inside", *since) <= level).mean())) for level in LEVELS
            ]
            for when, since in {
                "before": INTERVALS[0],
                "0 to 10 s": (0.0, 10.0),
                "10 to 30 s": (10.0, 30.0),
            }.items()
        }
        alarms = np.concatenate([each.alarms for each in drives])
        early, soon = int((alarms < 0.0).sum()), int(((alarms >= 0.0) & (alarms < 60.0)).sum())
        print(f"{learner:9s} inside {inside}; announced {early} times before, {soon} times within 60 s")


def print_lasting(found: dict[Job, Found]) -> None:
    """Print what false changes cost on long drives over one ground."""
    for job in dict.fromkeys(replace(job, seed=0) for job in found):
        plain = replace(job, learner="unwatched")
        same = {
            learner: [each for other, each in found.items() if replace(other, seed=0) == learner]
            for learner in (job, plain)
        }
        errors = {
            value: within(same[job], value, *WHOLE).mean() / within(same[plain], value, *WHOLE).mean()
            for value in ("heading", "position")
        }
        alarms = sum(len(each.alarms) for each in same[job])
        print(
            f"{job.input:8s}{job.noise:7s} lasts {job.correlation_time:2.0f} s {job.learner:10s} heading "
            f"{errors['heading']:.3f}, position {errors['position']:.3f} of never changing; "
            f"announced {alarms} times"
        )


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--embargo", type=float, default=0.0, help="s; predictions use what was known before")
    options = parser.parse_args()
    learners = ("unwatched", "branches", "told")
    with ProcessPoolExecutor(options.workers) as pool:
        for name in ("wheel", "command"):
            kinds = itertools.product(NOISES, FACTORS, range(options.seeds), learners)
            jobs = [
                Job(noise, name, factor, seed, way, options.embargo, step_at=STEP_AT + seed % HORIZON)
                for noise, factor, seed, way in kinds
            ]
            found = dict(zip(jobs, pool.map(learned, jobs), strict=True))
            print(f"\n{name}: errors over those of a learner that is told of the change\n")
            print_steps(found, learners, "heading")
            print_steps(found, learners, "position")
            print_coverage(found, learners)
        long = [("rough", 5.0), *(("5 s", seconds) for seconds in LASTING)]
        steady = itertools.product(("wheel", "command"), long, ("branches", "unwatched"), range(4))
        jobs = [
            Job(noise, name, 1.0, seed, way, 0.0, 20.0, lasts) for name, (noise, lasts), way, seed in steady
        ]
        print("\nOne ground for 20 minutes\n")
        print_lasting(dict(zip(jobs, pool.map(learned, jobs), strict=True)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
