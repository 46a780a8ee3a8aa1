# SPDX-License-Identifier: Apache-2.0
"""Is the reported uncertainty of the parameters true? Seeded Monte-Carlo drives with known slip and noise.

For each run the true parameters are drawn from the prior, a ten-minute drive with white slip noise and pose
noise is simulated step by step, and a filter learns from it: the IEKF on disjoint 5 s windows. For comparison
the same filter is fed 20 times a second with overlapping 5 s windows, as the thesis does (its Table 6.1).

A second table has every estimator on shorter drives, with windows that share poses as in a real log, once
with the noise above and once with poses so noisy that they outweigh the slip noise. The experiment itself is
`slipwise_thesis.monte_carlo`.
"""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

import numpy as np

from slipwise import _core
from slipwise_thesis.monte_carlo import (
    ESTIMATORS,
    NOISE,
    POSE_NOISE,
    WINDOW_STEPS,
    Feeding,
    RunResult,
    judged,
    known_run,
    learned,
    nees_band,
    summary,
)

MINUTES, ESTIMATOR_MINUTES = 10, 3
TRUTHS = ("odd-even-10", "thesis-15")
# Label, estimator, most runs.
FILTERS = (
    ("iekf, disjoint", Feeding("iekf", WINDOW_STEPS + 1), 1_000_000),
    ("overlapping (thesis)", Feeding("iekf", 1), 100),
)
ESTIMATOR_RUNS = 100
NOISES = {"slip and poses": NOISE, "mostly poses": POSE_NOISE}


def one_run(job: tuple[str, int, Feeding]) -> RunResult:
    """Simulate and learn one seed."""
    name, seed, feeding = job
    drive = known_run(name, seed, minutes=MINUTES)
    return judged(learned(feeding, drive), drive)


def estimators_on_one_drive(job: tuple[str, int]) -> list[RunResult]:
    """Learn one seed with every estimator, in the order of `ESTIMATORS`."""
    noise, seed = job
    drive = known_run(TRUTHS[0], seed, NOISES[noise], minutes=ESTIMATOR_MINUTES)
    return [judged(learned(feeding, drive), drive) for feeding in ESTIMATORS]


def compare_estimators(runs: int) -> dict[str, object]:
    """Print and return the table of all estimators."""
    report = {}
    size = _core.named_basis(TRUTHS[0]).size
    low, high = nees_band(runs, size)
    print(f"\n{'noise':16s} {'estimator':31s}  runs  NEES/m  95 % band")
    for noise in NOISES:
        with ProcessPoolExecutor() as pool:
            drives = list(
                pool.map(estimators_on_one_drive, [(noise, seed) for seed in range(runs)], chunksize=5)
            )
        for feeding, results in zip(ESTIMATORS, zip(*drives, strict=True), strict=True):
            figures, label = summary(results, size), feeding.label
            print(f"{noise:16s} {label:31s} {runs:5d} {figures['nees_over_m']:7.3f}  {low:.3f} .. {high:.3f}")
            report[f"{noise}/{label}"] = {**figures, "runs": [asdict(r) for r in results]}
    return report


def show(name: str, label: str, results: list[RunResult]) -> None:
    """Print one row of the table."""
    low, high = nees_band(len(results), _core.named_basis(name).size)
    fractions = [
        100.0 * np.mean([getattr(r, k) for r in results])
        for k in ("within_sigma", "within_90", "in_region_90")
    ]
    print(
        f"{name:12s} {label:21s} {len(results):5d} {np.mean([r.nees for r in results]):7.3f}"
        f"  {low:.3f} .. {high:.3f}"
        f" {fractions[0]:7.1f} % {fractions[1]:9.1f} % {fractions[2]:8.1f} %",
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
        for label, feeding, most in FILTERS:
            jobs = [(name, seed, feeding) for seed in range(min(options.runs, most))]
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
