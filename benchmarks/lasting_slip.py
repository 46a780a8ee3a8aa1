# SPDX-License-Identifier: Apache-2.0
"""What is learned of slip where it lasts for seconds, beside generalised least squares.

Robots of `promises/disturbed_robot.py` drive with white slip noise, and with slip that is correlated over 5,
20 and 60 s, for 30 such times and at least 10 minutes. From wheel speeds, the learner's forward slip and yaw
slip are held against the truth: rms errors, and rms of errors over reported standard deviations. The same of
least squares over increments of 1 s with the true law of slip, with the law that the learner learned, and
with white noise whose variances are times the segments that err alike, (1 + a) / (1 - a) for a correlation a
of neighbours. A learner without branches (`change.branches`) is beside it. Errors of its predictions over 5 s
are held-out ones without embargo.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

if __name__ == "__main__":  # run by its path as well as imported from the root
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from benchmarks.promises.disturbed_robot import Disturbance, DisturbedRun, Robot, disturbed_run
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.core_settings import core_settings
from slipwise.calibration.prepared_run import prepare_run
from slipwise.calibration.settings import Settings
from slipwise.segments import recording_of

Floats = NDArray[np.float64]

LASTING = (0.0, 5.0, 20.0, 60.0)  # s; 0: white
SPEED, TURN = 0.9, 0.4  # m/s and rad/s at which slip is compared
HORIZON, SEGMENT = 5.0, 1.0  # s
WHITE = 0.2  # of the white noise of a robot, where slip lasts
Law = list[tuple[float, float]]  # variances of a fraction and correlation times [s], summed


@dataclass(frozen=True)
class Found:
    """One drive: errors and reported standard deviations of forward and yaw slip, by method."""

    slip: dict[str, Floats]  # [2, 2]
    prediction: tuple[float, float]  # mean errors over 5 s [m, rad]


def contrasts(rates: Callable[[float, float], Floats]) -> Floats:
    """Return the forward slip at a speed, and how yaw slip grows with the yaw rate, both as fractions."""
    left, right = rates(SPEED, TURN), rates(SPEED, -TURN)
    return np.array([(left[0] + right[0]) / (2.0 * SPEED), (left[2] - right[2]) / (2.0 * TURN)])


def of_learner(learner: _core.MotionLearner, run: DisturbedRun) -> Floats:
    """Return errors and standard deviations of what was learned."""
    motion = learner.model().motion
    basis, slips = motion.model.basis, motion.model.slip_size

    def contrasts_of(mean: Floats) -> Floats:
        return contrasts(
            lambda v, w: np.asarray(_core.slip_rate(basis, mean, _core.SlipState(v, w, 0.0, 0.0)))
        )

    by = np.column_stack([contrasts_of(unit) for unit in np.eye(slips)])
    off = by @ motion.estimate.mean[:slips] - contrasts(run.rates)
    return np.array([off, np.sqrt(np.diag(by @ motion.estimate.covariance[:slips, :slips] @ by.T))])


def learned_laws(learner: _core.MotionLearner) -> tuple[Law, Law]:
    """Return the laws of the disturbance of forward and yaw slip, as the learner has them."""
    law, motion = learner.model().disturbance.law, learner.model().motion
    names = [each.name for each in motion.model.parameters]
    laws: list[Law] = []
    for name, size in (("lon.V", "linear"), ("ang.w", "angular")):
        std = motion.prior_std[names.index(name)] if name in names else 0.0
        laws.append(
            [
                (weight * (getattr(each, size) * std) ** 2, each.time_constant)
                for each, weight in zip(law.candidates, law.weights, strict=True)
            ]
        )
    return laws[0], laws[1]


def increments(run: DisturbedRun) -> tuple[Floats, Floats, Floats, Floats]:
    """Return motion and slip of segments of 1 s [2, N], their terms [2, N, 2], and times [N]."""
    poses, wheels = run.log.runs[0].poses, run.log.runs[0].wheels
    if wheels is None:
        raise ValueError("a simulated drive has wheel speeds")
    dt, yaw = float(poses.t[1] - poses.t[0]), np.unwrap(poses.yaw)
    every = round(SEGMENT / dt)
    count = len(wheels.t) // every
    middle = (yaw[1:] + yaw[:-1]) / 2.0
    steps = np.array([np.cos(middle) * np.diff(poses.x) + np.sin(middle) * np.diff(poses.y), np.diff(yaw)])

    def summed(values: Floats) -> Floats:
        return np.asarray(values[..., : count * every].reshape(*values.shape[:-1], count, every).sum(axis=-1))

    motion = summed(np.array([wheels.v, wheels.omega])) * dt
    terms = np.array([[motion[0], summed(wheels.v * np.abs(wheels.omega)) * dt], [motion[1], motion[0]]])
    t: Floats = np.arange(count) * SEGMENT
    return motion, summed(steps) - motion, np.asarray(terms.transpose(0, 2, 1)), t


def least_squares(run: DisturbedRun, robot: Robot, laws: tuple[Law, Law], alike: Floats | None) -> Floats:
    """Return errors and standard deviations of least squares, weighted with laws or with `alike` segments."""
    motion, slip, terms, t = increments(run)
    white = robot.disturbance.white**2 * np.array([robot.white[0], robot.white[2]])
    found = np.empty((2, 2))
    for i, law in enumerate(laws):
        y, x = slip[i], terms[i]
        pose = robot.pose_std[i] ** 2 + (0.0 if i else 0.01 * robot.pose_std[1] ** 2)
        noise = 2.0 * pose * np.eye(len(y)) - pose * (np.eye(len(y), k=1) + np.eye(len(y), k=-1))
        noise += np.diag(white[i] * (np.abs(motion[0]) + 0.3 * np.abs(motion[1])) + 1e-9)
        lasting = sum(size * np.exp(-np.abs(t[:, None] - t) / tau) for size, tau in law)
        everything = noise + lasting * np.outer(motion[i], motion[i])
        used = everything if alike is None else alike[i] * np.diag(np.diag(everything))
        weighted = np.linalg.solve(used, x)
        covariance = np.linalg.inv(x.T @ weighted)
        b = covariance @ (weighted.T @ y)
        by = np.array([1.0, TURN]) if i == 0 else np.array([1.0, 0.0])
        found[:, i] = by @ b, np.sqrt(by @ covariance @ by)
    found[0] -= contrasts(run.rates)
    return found


def learned(run: DisturbedRun, *, branches: bool) -> _core.MotionLearner:
    """Learn a drive as it comes."""
    core = core_settings(Settings.model_validate({"change": {"branches": branches}}), "wheel", (HORIZON,))
    stream = core.stream
    stream.embargo = 0.0
    core.stream = stream
    learner = _core.MotionLearner(core)
    (prepared,) = prepare_run(run.log, "wheel")
    learner.start_run()
    learner.push(recording_of(prepared.run))
    learner.end_run()
    return learner


def measured(job: tuple[float, int]) -> Found:
    """Learn one drive."""
    lasts, seed = job
    disturbance = Disturbance(WHITE, 1.0) if lasts else Disturbance()
    robot = Robot(disturbance=disturbance, correlation_time=lasts or 5.0)
    run = disturbed_run(robot, max(10.0, lasts / 2.0), seed=seed)
    learner = learned(run, branches=True)
    slow = robot.disturbance.slow * np.array([robot.slow[0], robot.slow[2]])
    laws = tuple([(size**2, lasts or 1.0)] for size in slow)
    a = np.exp(-SEGMENT / lasts) if lasts else 0.0
    slip = {
        "learner": of_learner(learner, run),
        "never jumping": of_learner(learned(run, branches=False), run),
        "true law": least_squares(run, robot, (laws[0], laws[1]), None),
        "learned law": least_squares(run, robot, learned_laws(learner), None),
        "alike count once": least_squares(run, robot, (laws[0], laws[1]), np.full(2, (1.0 + a) / (1.0 - a))),
    }
    held = learner.model().held_out[0].columns()
    left = held.measured - held.pose
    yaw = np.abs(np.arctan2(np.sin(left[:, 2]), np.cos(left[:, 2])))
    return Found(slip, (float(np.hypot(left[:, 0], left[:, 1]).mean()), float(yaw.mean())))


def main() -> int:
    """Print a line for each time and method."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = list(itertools.product(LASTING, range(options.seeds)))
    with ProcessPoolExecutor(options.workers) as pool:
        found = dict(zip(jobs, pool.map(measured, jobs), strict=True))
    print("slip lasts  method              forward: error   rms z   yaw: error   rms z")
    for lasts in LASTING:
        drives = [each for job, each in found.items() if job[0] == lasts]
        for method in drives[0].slip:
            off, std = np.array([each.slip[method] for each in drives]).transpose(1, 0, 2)
            error, z = np.sqrt((off**2).mean(axis=0)), np.sqrt(((off / std) ** 2).mean(axis=0))
            print(f"{lasts:7.0f} s   {method:18s} {error[0]:16.4f} {z[0]:7.2f} {error[1]:12.4f} {z[1]:7.2f}")
        position, heading = np.mean([each.prediction for each in drives], axis=0)
        print(f"{'':12s}5 s ahead: {position:.4f} m, {heading:.5f} rad")
    return 0


if __name__ == "__main__":
    sys.exit(main())
