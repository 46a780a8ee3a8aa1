# SPDX-License-Identifier: Apache-2.0
"""Slip of each track and side-slip angle from a table of steady states, cross-validated.

The table is that of a tracked robot indoors (github.com/mfocchi/tracked_robot_simulator, Apache-2.0; Focchi
et al., arXiv 2409.18641): commanded speeds `wheel_l`, `wheel_r`, slip `beta_l`, `beta_r` of each side, and
the angle `alpha` [rad] from the robot's x axis to its velocity. Slip is Bayesian linear regression on terms
of V and w; the angle is that of a robot whose centre of rotation lies off its middle: tan(alpha) = b w / V,
one number.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from slipwise import _core

Floats = NDArray[np.float64]

FOLDS, SEEDS = 10, 20
FULL_SPEED = 100.0  # of the table's unit, so that terms are about as large as each other
PRIOR_STD, NOISE_STD = 0.3, 0.01  # of a weight and of an example
BASES = {
    "linear": ("V", "w"),
    "odd": ("V", "w", "V*abs(w)", "w*abs(V)", "abs(w)*w", "abs(V)*V"),
    "odd and even": (
        *("V", "w", "V*abs(w)", "w*abs(V)", "abs(w)*w", "abs(V)*V", "w^3", "V^3", "V*w^2", "V^2*w"),
        *("V^2", "w^2", "V*w", "abs(V)", "abs(w)", "sgn(V)*abs(w)"),
    ),
}


def folds(count: int, seed: int) -> NDArray[np.int64]:
    """Return the fold of each row [count]."""
    return np.random.default_rng(seed).permutation(count) % FOLDS


def features(terms: tuple[str, ...], v: Floats, w: Floats) -> Floats:
    """Return the terms [rows, terms] of each steady state."""
    return np.asarray(_core.feature_rows(_core.Basis("steady", list(terms), [], []), v, w))


def explained(truth: Floats, predicted: Floats) -> float:
    """Return the part of the variance that predictions explain."""
    return float(1.0 - np.sum((truth - predicted) ** 2) / np.sum((truth - truth.mean()) ** 2))


def slip_score(terms: tuple[str, ...], v: Floats, w: Floats, slip: Floats, seed: int) -> float:
    """Cross-validate a regression of a side's slip."""
    rows, fold, predicted = features(terms, v, w), folds(len(slip), seed), np.empty(len(slip))
    for k in range(FOLDS):
        weights = np.full(rows.shape[1], PRIOR_STD)
        regression = _core.BayesianRegression(weights, NOISE_STD, np.inf)
        for x, y in zip(rows[fold != k], slip[fold != k].tolist(), strict=True):
            regression.add(_core.RegressionExample(x, y, 1.0))
        predicted[fold == k] = rows[fold == k] @ regression.mean
    return explained(slip, predicted)


def wrapped(angle: Floats) -> Floats:
    """Return angles in (-pi, pi]."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def angle_score(v: Floats, w: Floats, alpha: Floats, seed: int) -> float:
    """Cross-validate the one number b of tan(alpha) = b w / V, by v sin(alpha) = b w cos(alpha)."""
    fold, off = folds(len(alpha), seed), np.empty(len(alpha))
    for k in range(FOLDS):
        x, y = (w * np.cos(alpha))[fold != k], (v * np.sin(alpha))[fold != k]
        b = float(x @ y / (x @ x))
        off[fold == k] = wrapped(alpha - np.arctan2(b * w, v))[fold == k]
    return float(1.0 - np.sum(off**2) / np.sum((alpha - alpha.mean()) ** 2))


def mean_of(score: Callable[[int], float]) -> float:
    """Average over several ways of folding."""
    return float(np.mean([score(seed) for seed in range(SEEDS)]))


def main() -> None:
    """Print a row of JSON for each quantity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("table", type=Path, help="wheel_l, wheel_r, beta_l, beta_r, alpha")
    table = pd.read_csv(parser.parse_args().table)
    left, right, alpha = (table[name].to_numpy(np.float64) for name in ("wheel_l", "wheel_r", "alpha"))
    v, w = (left + right) / 2.0 / FULL_SPEED, (right - left) / 2.0 / FULL_SPEED
    for side in ("beta_l", "beta_r"):
        slip = table[side].to_numpy(np.float64)
        for name, terms in BASES.items():
            score = mean_of(lambda seed, t=terms, y=slip: slip_score(t, v, w, y, seed))  # type: ignore[misc]
            print(json.dumps({"quantity": side, "terms": name, "R2": round(score, 3), "rows": len(table)}))
    score = mean_of(lambda seed: angle_score(v, w, alpha, seed))
    print(json.dumps({"quantity": "alpha", "terms": "tan(alpha) = b w / V", "R2": round(score, 3)}))


if __name__ == "__main__":
    main()
