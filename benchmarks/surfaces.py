# SPDX-License-Identifier: Apache-2.0
"""Times and held-out scores of the slip surfaces: thesis chapter 5's O(N^3) against O(d^2), measured."""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ.setdefault(
    "OPENBLAS_NUM_THREADS", "1"
)  # processor time of one core, whatever else the machine does

import numpy as np

from slipwise import _core
from slipwise_thesis import _thesis
from slipwise_thesis.surfaces import (
    BayesianOptions,
    BayesianSurface,
    GaussianProcessOptions,
    GaussianProcessSurface,
    LeastSquaresSurface,
    SlipExamples,
    score_surface,
    slip_examples,
)

BASIS = _core.named_basis("odd-even-10")
ALPHA = np.array([-0.05, -0.02, -0.01, 0.03, -0.04, 0.01, -0.4, 0.05, 0.03, 0.01])
SIZES = (100, 1_000, 10_000)
LARGE = 1_000  # a Gaussian process of more examples is factored once here
KINDS: dict[str, Callable[[], Any]] = {
    "least squares": lambda: LeastSquaresSurface(BASIS),
    "least squares, thesis spread": lambda: LeastSquaresSurface(BASIS, spread="thesis"),
    "gaussian process": lambda: GaussianProcessSurface(options=GaussianProcessOptions(largest=20_000)),
    "bayesian": lambda: BayesianSurface(BASIS),
    "bayesian, window 200": lambda: BayesianSurface(BASIS, options=BayesianOptions(window=200)),
}


def draw(count: int, seed: int) -> SlipExamples:
    """Draw segments of a known slip law, with a term that no basis holds and noise that grows with speed."""
    random = np.random.default_rng(seed)
    v, omega = random.uniform(0.3, 2.5, count), random.uniform(-1.0, 1.0, count)
    slip = _thesis.feature_rows(BASIS, v, omega)
    parts = (slice(0, 3), slice(3, 6), slice(6, 10))
    law = np.column_stack([slip[:, part] @ ALPHA[part] for part in parts])
    law[:, 0] -= 0.05 * np.tanh(4.0 * np.abs(omega) - 2.0)  # the tyres let go
    spread = np.column_stack((0.01 + 0.01 * v, 0.005 + 0.005 * v, 0.02 + 0.02 * v))
    return slip_examples(np.column_stack((v, omega)), law + spread * random.standard_normal((count, 3)))


def seconds(work: Callable[[], object]) -> float:
    """Run `work` once and return the processor time that it took."""
    start = time.process_time()
    work()
    return time.process_time() - start


def measure(name: str, count: int) -> dict[str, Any]:
    """Fit to `count` examples, add one, score on others."""
    surface = KINDS[name]()
    examples, one = draw(count, 1), draw(1, 2)
    if name == "gaussian process" and count > LARGE:
        # One factorization tells both times: to add an example is to factor all anew.
        shape = seconds(lambda: surface.fit(examples[:LARGE]))
        add = seconds(lambda: surface.update(examples[LARGE:].joined(one)))
        fit = shape + add
    else:
        fit = seconds(lambda: surface.fit(examples))
        add = seconds(lambda: surface.update(one))
    score = score_surface(surface, draw(1000, 3))
    return {
        "surface": name,
        "examples": count,
        "fit_s": fit,
        "add_s": add,
        "error": score.error.tolist(),
        "log_score": score.log_score.tolist(),
        "coverage": score.coverage.tolist(),
    }


def row(result: dict[str, Any]) -> str:
    """Return one row of the table."""
    error = " ".join(f"{value:.4f}" for value in result["error"])
    log_score = " ".join(f"{value:5.2f}" for value in result["log_score"])
    inside = " ".join(f"{value:.2f}" for value in result["coverage"][-1])
    times = f"{result['fit_s']:.4f} | {1e3 * result['add_s']:.3f}"
    return f"| {result['surface']} | {result['examples']} | {times} | {error} | {log_score} | {inside} |"


def main() -> int:
    """Measure every surface at every size that its limit allows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures here as well")
    parser.add_argument("--quick", action="store_true", help="the Gaussian process at most at 1 000 examples")
    arguments = parser.parse_args()
    print("| surface | N | fit [s] | add one [ms] | mean error lon lat ang | log score | inside 95 % |")
    print("|---|---|---|---|---|---|---|")
    for make in KINDS.values():
        make().fit(draw(30, 4))  # libraries are loaded before anything is timed
    results = []
    for name in KINDS:
        for count in SIZES:
            if arguments.quick and name == "gaussian process" and count > 1_000:
                continue
            results.append(measure(name, count))
            print(row(results[-1]), flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
