# SPDX-License-Identifier: Apache-2.0
"""Is the stated uncertainty of the parameters true? Seeded Monte-Carlo drives with known slip and noise.

For each run the true parameters are drawn from the prior, a ten-minute drive with white slip noise and pose
noise is simulated step by step, and a filter learns from it: the IEKF on disjoint 5 s windows. For comparison
the same filter is fed 20 times a second with overlapping 5 s windows, as the thesis does (its Table 6.1).

A second table has every estimator on the same shorter drives, with windows that share poses as in a real log,
once with the noise above and once with poses so noisy that they outweigh the slip noise.
"""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

STEP = 0.05  # s, commands and poses at 20 Hz
WINDOW = 5.0  # s
MINUTES = 10
TRUTHS = ("odd-even-10", "thesis-15")
SPEEDS = (1.5, 0.6)  # reference speed [m/s] and yaw rate [rad/s] of the prior
SLIP_FRACTION = (
    0.1  # per term; with 15 terms drawn at once the default of 0.3 would slip more than the robot moves
)
NOISE = _core.MotionNoise([4e-4, 4e-4, 1e-4], [0.0] * 3, [0.0] * 3, 0.01, 0.003)
SIGMAS_90 = 1.6448536269514722
# Label, steps between the starts of windows, most runs. One step more than the window makes windows
# independent: neighbours share no pose and so no pose noise.
FILTERS = (
    ("iekf, disjoint", int(WINDOW / STEP) + 1, 1_000_000),
    ("overlapping (thesis)", 1, 100),
)
# Estimators: name, steps between the starts of windows, Jacobian.
EXACT, THESIS = _core.SegmentJacobian.Exact, _core.SegmentJacobian.Thesis
SHARED = int(WINDOW / STEP)
ESTIMATORS = (
    ("gradient-descent", 1, EXACT),
    ("ekf-thesis", 1, THESIS),
    ("ekf-thesis", 1, EXACT),
    ("iekf", SHARED, EXACT),
    ("delayed-state", SHARED, EXACT),
)
ESTIMATOR_MINUTES, ESTIMATOR_RUNS = 3, 100
POSE_NOISE = _core.MotionNoise([2e-5, 2e-5, 1e-5], [0.0] * 3, [0.0] * 3, 0.03, 0.01)
NOISES = {"slip and poses": NOISE, "mostly poses": POSE_NOISE}
CHI_SQUARE_90 = {10: 15.987179172105261, 15: 22.307129581578689}


@dataclass(frozen=True)
class RunResult:
    """One filter on one drive: NEES / m, parameters within their intervals, and the joint region."""

    nees: float
    within_sigma: float
    within_90: float
    in_region_90: bool


def commands(rng: np.random.Generator, minutes: float) -> tuple[Floats, Floats, Floats]:
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


def drive(
    basis: _core.Basis,
    alpha: Floats,
    rng: np.random.Generator,
    noise: _core.MotionNoise = NOISE,
    minutes: float = MINUTES,
) -> tuple[_core.InputTrack, list[_core.Pose2]]:
    """Simulate the drive step by step; return the inputs and the measured poses."""
    t, v, omega = commands(rng, minutes)
    psd = np.sqrt(np.array(noise.psd_time) * STEP)
    pose, measured = _core.Pose2(0.0, 0.0, 0.0), []
    for speed, rate in zip(v.tolist(), omega.tolist(), strict=True):
        measured.append(disturbed(pose, rng, noise))
        slip = _core.slip_rate(basis, alpha, _core.SlipState(speed, rate, 0.0, 0.0))
        tangent = (np.array([speed, 0.0, rate]) + slip) * STEP + psd * rng.standard_normal(3)
        pose = _core.compose(pose, _core.exp(tangent))
    measured.append(disturbed(pose, rng, noise))
    return _core.InputTrack(t, v, np.zeros_like(v), omega), measured


def disturbed(pose: _core.Pose2, rng: np.random.Generator, noise: _core.MotionNoise) -> _core.Pose2:
    """Return the pose as a sensor would measure it."""
    x, y, theta = rng.standard_normal(3) * (noise.pose_std_xy, noise.pose_std_xy, noise.pose_std_yaw)
    return _core.Pose2(pose.x + x, pose.y + y, pose.theta + theta)


def learn(
    model: _core.MotionModel,
    prior: _core.Estimate,
    data: tuple[_core.InputTrack, list[_core.Pose2]],
    stride: int,
) -> _core.Estimate:
    """Learn windows of 5 s that start every `stride` steps."""
    track, poses = data
    settings = _core.IekfSettings()
    settings.huber, settings.gate = 1e9, 1e18  # the noise is Gaussian, nothing is an outlier
    length, estimate = int(WINDOW / STEP), prior
    for i in range(0, len(poses) - length, stride):
        measured = _core.between(poses[i], poses[i + length])
        segment = _core.Segment(i * STEP, (i + length) * STEP, measured, None, 0.0, 0.0)
        path = _core.integrate_segment(model, estimate.mean, track, segment, _core.Integrator.Exact)
        noise = _core.slip_covariance(path, NOISE) + _core.pose_noise_covariance(measured, NOISE)
        estimate = _core.iekf_update(model, estimate, track, segment, noise, settings).estimate
    return estimate


def judged(estimate: _core.Estimate, truth: Floats) -> RunResult:
    """Compare an estimate with the true parameters."""
    error = estimate.mean - truth
    covariance = np.array(estimate.covariance)
    squared = float(error @ np.linalg.solve(covariance, error))
    sigmas = np.abs(error) / np.sqrt(np.diag(covariance))
    return RunResult(
        nees=squared / len(truth),
        within_sigma=float(np.mean(sigmas <= 1.0)),
        within_90=float(np.mean(sigmas <= SIGMAS_90)),
        in_region_90=squared <= CHI_SQUARE_90[len(truth)],
    )


def one_run(job: tuple[str, int, int]) -> RunResult:
    """Simulate and learn one seed with windows that start every `stride` steps."""
    name, seed, stride = job
    rng = np.random.default_rng(seed)
    model, prior, truth = drawn(name, rng)
    return judged(learn(model, prior, drive(model.basis, truth, rng), stride), truth)


def drawn(basis: str, rng: np.random.Generator) -> tuple[_core.MotionModel, _core.Estimate, Floats]:
    """Return the model, its prior, and true parameters drawn from the prior."""
    model = _core.MotionModel(_core.named_basis(basis), False, False)
    prior_settings = _core.PriorSettings()
    prior_settings.slip_fraction = SLIP_FRACTION
    prior = _core.prior_estimate(model, *SPEEDS, prior_settings)
    return model, prior, np.sqrt(np.diag(prior.covariance)) * rng.standard_normal(model.size)


def estimators_on_one_drive(job: tuple[str, int]) -> list[RunResult]:
    """Learn one seed with every estimator, in the order of `ESTIMATORS`."""
    noise_name, seed = job
    noise, rng, results = NOISES[noise_name], np.random.default_rng(seed), []
    model, prior, truth = drawn(TRUTHS[0], rng)
    track, poses = drive(model.basis, truth, rng, noise, ESTIMATOR_MINUTES)
    length = int(WINDOW / STEP)
    for name, stride, jacobian in ESTIMATORS:
        settings = _core.EstimatorSettings()
        settings.noise, settings.ekf_thesis.jacobian = noise, jacobian
        settings.iekf.huber, settings.iekf.gate = 1e9, 1e18
        estimator = _core.make_estimator(name, model, prior, settings)
        for i in range(0, len(poses) - length, stride):
            measured = _core.between(poses[i], poses[i + length])
            segment = _core.Segment(i * STEP, (i + length) * STEP, measured, None, 0.0, 0.0)
            estimator.learn(track, segment)
        results.append(judged(estimator.estimate(), truth))
    return results


def compare_estimators(runs: int) -> dict[str, object]:
    """Print and return the table of all estimators."""
    report = {}
    print(f"\n{'noise':16s} {'estimator':31s}  runs  NEES/m  95 % band")
    for noise in NOISES:
        with ProcessPoolExecutor() as pool:
            drives = list(
                pool.map(estimators_on_one_drive, [(noise, seed) for seed in range(runs)], chunksize=5)
            )
        for (name, stride, jacobian), results in zip(ESTIMATORS, zip(*drives, strict=True), strict=True):
            fed = "20 Hz" if stride == 1 else "shared poses"
            label = f"{name}, {fed}" + (", (6.7)" if jacobian == THESIS else "")
            figures = summary(list(results), _core.named_basis(TRUTHS[0]).size)
            low, high = nees_band(runs, _core.named_basis(TRUTHS[0]).size)
            print(f"{noise:16s} {label:31s} {runs:5d} {figures['nees_over_m']:7.3f}  {low:.3f} .. {high:.3f}")
            report[f"{noise}/{label}"] = {**figures, "runs": [asdict(r) for r in results]}
    return report


def nees_band(runs: int, size: int) -> tuple[float, float]:
    """95 % band of the mean NEES / m over independent runs (chi-square, Wilson-Hilferty)."""
    spread = 2.0 / (9.0 * runs * size)
    low, high = ((1.0 - spread + z * np.sqrt(spread)) ** 3 for z in (-1.96, 1.96))
    return float(low), float(high)


def summary(results: list[RunResult], size: int) -> dict[str, float | tuple[float, float]]:
    """Mean figures over the runs."""
    return {
        "nees_over_m": float(np.mean([r.nees for r in results])),
        "band_95": nees_band(len(results), size),
        "within_1_sigma": float(np.mean([r.within_sigma for r in results])),
        "within_90": float(np.mean([r.within_90 for r in results])),
        "in_90_region": float(np.mean([r.in_region_90 for r in results])),
    }


def show(name: str, label: str, results: list[RunResult]) -> None:
    """Print one row of the table."""
    low, high = nees_band(len(results), _core.named_basis(name).size)
    shares = [
        100.0 * np.mean([getattr(r, k) for r in results])
        for k in ("within_sigma", "within_90", "in_region_90")
    ]
    print(
        f"{name:12s} {label:21s} {len(results):5d} {np.mean([r.nees for r in results]):7.3f}"
        f"  {low:.3f} .. {high:.3f}"
        f" {shares[0]:7.1f} % {shares[1]:9.1f} % {shares[2]:8.1f} %",
        flush=True,
    )


def main() -> None:
    """Run all seeds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--json", type=Path, help="write the figures and every run's result here")
    options = parser.parse_args()
    report: dict[str, object] = {}
    print(f"{'truth':12s} {'filter':21s}  runs  NEES/m  95 % band        1 sigma  90 % interval  90 % region")
    for name in TRUTHS:
        for label, stride, most in FILTERS:
            jobs = [(name, seed, stride) for seed in range(min(options.runs, most))]
            with ProcessPoolExecutor() as pool:
                results = list(pool.map(one_run, jobs, chunksize=5))
            show(name, label, results)
            figures = summary(results, _core.named_basis(name).size)
            report[f"{name}/{label}"] = {**figures, "runs": [asdict(r) for r in results]}
    report |= compare_estimators(min(options.runs, ESTIMATOR_RUNS))
    if options.json:
        options.json.write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
