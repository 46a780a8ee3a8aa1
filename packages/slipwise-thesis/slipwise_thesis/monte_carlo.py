# SPDX-License-Identifier: Apache-2.0
"""Drives with known slip and noise, to hold the covariance of every estimator against the truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise.calibration.statistics import chi_square_band
from slipwise_thesis import _thesis

Floats = NDArray[np.float64]

STEP = 0.05  # s, commands and poses at 20 Hz
WINDOW = 5.0  # s
WINDOW_STEPS = round(WINDOW / STEP)
SPEEDS = (1.5, 0.6)  # reference speed [m/s] and yaw rate [rad/s] of the prior
SLIP_FRACTION = (
    0.1  # per term; with 15 terms drawn at once the default of 0.3 would slip more than the robot moves
)
NOISE = _core.MotionNoise([4e-4, 4e-4, 1e-4], [0.0] * 3, [0.0] * 3, 0.01, 0.003)
POSE_NOISE = _core.MotionNoise([2e-5, 2e-5, 1e-5], [0.0] * 3, [0.0] * 3, 0.03, 0.01)
SIGMAS_90 = 1.6448536269514722
CHI_SQUARE_90 = {10: 15.987179172105261, 15: 22.307129581578689}  # by the number of parameters
NO_OUTLIERS = (1e9, 1e18)  # Huber's limit and the gate: the noise is Gaussian


@dataclass(frozen=True)
class Feeding:
    """An estimator, and how it is fed."""

    estimator: str  # a name of `make_estimator`
    stride: int = WINDOW_STEPS  # steps between the starts of windows; one more and neighbours share no pose
    jacobian: _thesis.SegmentJacobian = _thesis.SegmentJacobian.Exact  # of ekf-thesis

    @property
    def label(self) -> str:
        """The estimator and what is peculiar about its windows."""
        fed = {1: "20 Hz", WINDOW_STEPS: "shared poses"}.get(self.stride, "no shared pose")
        thesis = ", (6.7)" if self.jacobian == _thesis.SegmentJacobian.Thesis else ""
        return f"{self.estimator}, {fed}{thesis}"


ESTIMATORS = (
    Feeding("gradient-descent", 1),
    Feeding("ekf-thesis", 1, _thesis.SegmentJacobian.Thesis),
    Feeding("ekf-thesis", 1),
    Feeding("iekf"),
    Feeding("iekf", WINDOW_STEPS + 1),
    Feeding("delayed-state"),
    Feeding("batch"),
)


@dataclass(frozen=True, eq=False)
class KnownRun:
    """A drive whose parameters are known."""

    model: _core.MotionModel
    prior: _core.Estimate
    truth: Floats  # [parameters], drawn from the prior
    noise: _core.MotionNoise
    history: _core.InputHistory
    poses: list[_core.Pose2]  # measured, every `STEP`

    def segments(self, stride: int) -> Iterator[_core.Segment]:
        """Yield windows of `WINDOW` s that start every `stride` steps."""
        for i in range(0, len(self.poses) - WINDOW_STEPS, stride):
            measured = _core.between(self.poses[i], self.poses[i + WINDOW_STEPS])
            yield _core.Segment(i * STEP, (i + WINDOW_STEPS) * STEP, measured, None, 0.0, 0.0)


@dataclass(frozen=True)
class RunResult:
    """One estimator on one drive: NEES / m, parameters in their intervals, joint region, error."""

    nees: float
    within_sigma: float
    within_90: float
    in_region_90: bool
    error: float  # root mean square over the parameters, in units of the prior's standard deviations


def known_run(basis: str, seed: int, noise: _core.MotionNoise = NOISE, *, minutes: float) -> KnownRun:
    """Draw true parameters from the prior and simulate a drive, step by step."""
    rng = np.random.default_rng(seed)
    model = _core.MotionModel(_core.named_basis(basis), False, False)
    settings = _core.PriorSettings()
    settings.slip_fraction = SLIP_FRACTION
    prior = _core.prior_estimate(model, *SPEEDS, settings)
    truth = np.sqrt(np.diag(prior.covariance)) * rng.standard_normal(model.size)
    t, v, omega = _commands(rng, minutes)
    psd = np.sqrt(np.array(noise.psd_time) * STEP)
    pose, measured = _core.Pose2(0.0, 0.0, 0.0), []
    for speed, rate in zip(v.tolist(), omega.tolist(), strict=True):
        measured.append(_disturbed(pose, rng, noise))
        slip = _core.slip_rate(model.basis, truth, _core.SlipState(speed, rate, 0.0, 0.0))
        tangent = (np.array([speed, 0.0, rate]) + slip) * STEP + psd * rng.standard_normal(3)
        pose = _core.compose(pose, _core.exp(tangent))
    measured.append(_disturbed(pose, rng, noise))
    history = _core.InputHistory(t, v, np.zeros_like(v), omega)
    return KnownRun(model, prior, truth, noise, history, measured)


def learned(feeding: Feeding, drive: KnownRun) -> _core.Estimate:
    """Learn the whole drive."""
    settings = _thesis.EstimatorSettings()
    settings.noise, settings.ekf_thesis.jacobian = drive.noise, feeding.jacobian
    settings.iekf.huber, settings.iekf.gate = NO_OUTLIERS
    estimator = _thesis.make_estimator(feeding.estimator, drive.model, drive.prior, settings)
    for segment in drive.segments(feeding.stride):
        estimator.learn(drive.history, segment)
    return estimator.estimate()


def judged(estimate: _core.Estimate, drive: KnownRun) -> RunResult:
    """Compare an estimate with the true parameters."""
    error = estimate.mean - drive.truth
    covariance = np.array(estimate.covariance)
    squared = float(error @ np.linalg.solve(covariance, error))
    sigmas = np.abs(error) / np.sqrt(np.diag(covariance))
    return RunResult(
        nees=squared / len(error),
        within_sigma=float(np.mean(sigmas <= 1.0)),
        within_90=float(np.mean(sigmas <= SIGMAS_90)),
        in_region_90=squared <= CHI_SQUARE_90[len(error)],
        error=float(np.sqrt(np.mean(error**2 / np.diag(drive.prior.covariance)))),
    )


def nees_band(runs: int, size: int) -> tuple[float, float]:
    """95 % band of the mean NEES / m of `size` parameters over independent runs."""
    low, high = chi_square_band(runs, size)
    return low / size, high / size


def summary(results: Sequence[RunResult], size: int) -> dict[str, float | tuple[float, float]]:
    """Mean figures over the runs."""
    return {
        "nees_over_m": float(np.mean([r.nees for r in results])),
        "band_95": nees_band(len(results), size),
        "within_1_sigma": float(np.mean([r.within_sigma for r in results])),
        "within_90": float(np.mean([r.within_90 for r in results])),
        "in_90_region": float(np.mean([r.in_region_90 for r in results])),
    }


def _commands(rng: np.random.Generator, minutes: float) -> tuple[Floats, Floats, Floats]:
    """Held random speeds and curvatures (the thesis's ranges) for the whole drive."""
    count = int(minutes * 60 / STEP)
    t = np.arange(count, dtype=np.float64) * STEP
    held = rng.integers(20, 80, size=count)
    edges = np.minimum(np.cumsum(held), count)
    v, omega, begin = np.zeros(count), np.zeros(count), 0
    for end in edges.tolist():
        v[begin:end] = rng.uniform(0.3, 2.0) * rng.choice((1.0, 1.0, 1.0, -1.0))
        omega[begin:end] = v[begin:end] * rng.uniform(-0.5, 0.5)
        begin = end
    return t, v, omega


def _disturbed(pose: _core.Pose2, rng: np.random.Generator, noise: _core.MotionNoise) -> _core.Pose2:
    """Return the pose as a sensor would measure it."""
    x, y, theta = rng.standard_normal(3) * (noise.pose_std_xy, noise.pose_std_xy, noise.pose_std_yaw)
    return _core.Pose2(pose.x + x, pose.y + y, pose.theta + theta)
