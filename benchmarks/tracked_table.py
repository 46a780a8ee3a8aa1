# SPDX-License-Identifier: Apache-2.0
"""How well slip terms fit a tracked robot's steady states, beside the boosted trees of the table's authors.

The table has commanded speeds of both tracks, slip of each track and the side-slip angle. Slip is learned
by the core's Bayesian regression on the terms of a basis; the angle is that of a twist whose forward and
sideways slip are proportional to the yaw rate. Every row is predicted from others alone: one left out, and
ten folds, in which the authors' method (CatBoost of github.com/mfocchi/tracked_robot_simulator, its settings
left as they come) stands beside where `catboost` is installed.

    python benchmarks/tracked_table.py tracked_ident_wheels_real_indoor.csv
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise import _core
from slipwise_thesis import _thesis

Floats = NDArray[np.float64]
Predictor = Callable[["Table", NDArray[np.bool_]], Floats]  # [N, 3] for all rows, from the rows of the mask

FASTEST = (
    160.0  # the table's unit of track speed, which its authors do not state; speeds are given in this one
)
DEGREE = 3  # of the slip terms
SLIP_STD = 0.1  # of each term's coefficient, in the table's unit of slip
NOISE = (0.03, 3.0)  # of one row's slip, and how many rows that is worth
ANGLE_STD = 0.05  # rad, of one row's angle, and where larger errors begin to weigh less
TURN_STD = 1.0  # of the two coefficients of the angle
ROUNDS = 12  # of the Gauss-Newton steps for the angle, from no slip at all
FOLDS = 10
OUTPUTS = ("slip of the left track", "slip of the right track", "side-slip angle")


@dataclass(frozen=True)
class Table:
    """Steady states of a robot that moves."""

    v: Floats  # [N] mean of both tracks, 1 is the fastest
    omega: Floats  # [N] half of their difference, right minus left
    measured: Floats  # [N, 3] slip left and right, side-slip angle [rad]


def read_table(path: Path) -> Table:
    """Read a table; rows that stand still are left out: they have no direction of travel."""
    rows = np.genfromtxt(path, delimiter=",", skip_header=1, ndmin=2)
    rows = rows[np.any(rows[:, :2] != 0.0, axis=1)]
    left, right = rows[:, 0] / FASTEST, rows[:, 1] / FASTEST
    return Table(0.5 * (left + right), 0.5 * (right - left), rows[:, 2:5])


def terms(degree: int) -> list[str]:
    """Return all products of powers of V and w up to a degree, each with and without their signs."""
    found = []
    for total in range(1, degree + 1):
        for b in range(total + 1):
            a = total - b
            forward = [f"V^{a}", f"sgn(V)*V^{a}"] if a else ["", "sgn(V)"]
            turning = [f"w^{b}", "*".join(["abs(w)"] + ["w"] * (b - 1))] if b else [""]
            found += ["*".join(part for part in (f, t) if part) for f in forward for t in turning]
    return found


def features(table: Table, names: list[str]) -> Floats:
    """Return the terms' values [N, terms]."""
    basis = _core.Basis("tracked", names, [], [])
    return np.array(
        [basis.features(_core.SlipState(v, w, 0.0, 0.0)) for v, w in zip(table.v, table.omega, strict=True)]
    )


def regression(x: Floats, y: Floats, std: float, noise: tuple[float, float]) -> _thesis.BayesianRegression:
    """Return a regression of y [N] on x [N, d]."""
    found = _thesis.BayesianRegression(np.full(x.shape[1], std), *noise)
    for row, output in zip(x, y, strict=True):
        found.add(_thesis.RegressionExample(row, float(output), 1.0))
    return found


def slip_left_out(table: Table, side: int) -> tuple[Floats, Floats]:
    """Return the slip of a side [N] with its deviation, each row predicted without itself."""
    x, y = features(table, terms(DEGREE)), table.measured[:, side]
    learned = regression(x, y, SLIP_STD, NOISE)
    mean, std = np.empty(len(y)), np.empty(len(y))
    for k in range(len(y)):
        example = _thesis.RegressionExample(x[k], float(y[k]), 1.0)
        learned.remove(example)
        (mean[k],), (std[k],) = learned.predict_rows(x[k : k + 1])
        learned.add(example)
    return mean, std


def angles(table: Table, turn: Floats) -> Floats:
    """Return the angle of the twist (V + turn[0] w, turn[1] w) [N], rad."""
    return np.asarray(np.arctan2(turn[1] * table.omega, table.v + turn[0] * table.omega))


def learn_turn(table: Table, rows: NDArray[np.bool_], start: Floats, rounds: int) -> Floats:
    """Return what yaw adds to forward and sideways speed [2], by regressions on the angle's derivatives."""
    v, w, measured = table.v[rows], table.omega[rows], table.measured[rows, 2]
    turn = start
    for _ in range(rounds):
        forward, sideways = v + turn[0] * w, turn[1] * w
        square = np.maximum(forward**2 + sideways**2, 1e-6)
        x = np.column_stack((-sideways * w / square, forward * w / square))
        error = wrapped(measured - np.arctan2(sideways, forward))
        spread = np.sqrt(1.0 + (error / ANGLE_STD) ** 2)
        learned = _thesis.BayesianRegression(np.full(2, TURN_STD), ANGLE_STD, np.inf)
        for row, output, relative in zip(x, error + x @ turn, spread, strict=True):
            learned.add(_thesis.RegressionExample(row, float(output), float(relative)))
        turn = np.asarray(learned.mean)
    return turn


def angle_left_out(table: Table) -> Floats:
    """Return the angle [N], each row predicted without itself."""
    whole = learn_turn(table, np.ones(len(table.v), dtype=bool), np.zeros(2), ROUNDS)
    found = np.empty(len(table.v))
    for k in range(len(found)):
        others = np.arange(len(found)) != k
        found[k] = angles(table, learn_turn(table, others, whole, 2))[k]
    return found


def by_terms(table: Table, rows: NDArray[np.bool_]) -> Floats:
    """Predict all rows from some, as slipwise does."""
    x = features(table, terms(DEGREE))
    sides = [
        regression(x[rows], table.measured[rows, side], SLIP_STD, NOISE).predict_rows(x)[0] for side in (0, 1)
    ]
    return np.column_stack((*sides, angles(table, learn_turn(table, rows, np.zeros(2), ROUNDS))))


def by_trees(table: Table, rows: NDArray[np.bool_]) -> Floats:
    """Predict all rows from some, as the table's authors do."""
    import catboost

    x = np.column_stack((table.v - table.omega, table.v + table.omega))
    columns = []
    for output in range(3):
        model = catboost.CatBoostRegressor(verbose=False, thread_count=1, allow_writing_files=False)
        columns.append(model.fit(x[rows], table.measured[rows, output]).predict(x))
    return np.column_stack(columns)


def wrapped(angle: Floats) -> Floats:
    """Return an angle within half a turn [rad]."""
    return np.asarray(np.angle(np.exp(1j * angle)))


def errors(table: Table, predicted: Floats) -> Floats:
    """Return predicted minus measured [N, 3]; angles differ by half a turn at most."""
    found = predicted - table.measured
    found[:, 2] = wrapped(found[:, 2])
    return found


def explained(table: Table, predicted: Floats) -> Floats:
    """Return the share of the outputs' variance that is explained [3] (R2)."""
    spread = table.measured - table.measured.mean(axis=0)
    return np.asarray(1.0 - np.sum(errors(table, predicted) ** 2, axis=0) / np.sum(spread**2, axis=0))


def folds(table: Table, seed: int) -> Iterator[NDArray[np.bool_]]:
    """Yield the rows of each fold, drawn by a seed."""
    drawn = np.random.default_rng(seed).permutation(len(table.v)) % FOLDS
    for fold in range(FOLDS):
        yield drawn == fold


def held_out(table: Table, method: Predictor, seed: int) -> Floats:
    """Return predictions [N, 3], each fold's from the others."""
    found = np.empty_like(table.measured)
    for fold in folds(table, seed):
        found[fold] = method(table, ~fold)[fold]
    return found


def print_scores(title: str, table: Table, predicted: Floats) -> None:
    """Print R2, the root of the mean square and the median of the errors of each output."""
    wrong = errors(table, predicted)
    print(f"\n{title}\n\n| output | R2 | rms error | median error |\n|---|---|---|---|")
    for name, r2, column in zip(OUTPUTS, explained(table, predicted), wrong.T, strict=True):
        print(f"| {name} | {r2:.4f} | {np.sqrt(np.mean(column**2)):.4f} | {np.median(np.abs(column)):.4f} |")


def main() -> None:
    """Fit the table and print how well rows are predicted that were not seen."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("table", type=Path, help="wheel_l, wheel_r, beta_l, beta_r, alpha")
    parser.add_argument("--seed", type=int, default=0, help="of the folds")
    arguments = parser.parse_args()
    table = read_table(arguments.table)
    turn = learn_turn(table, np.ones(len(table.v), dtype=bool), np.zeros(2), ROUNDS)
    print(f"{len(table.v)} steady states; of half the difference of the tracks, {turn[0]:+.4f} adds to the")
    print(f"forward and {turn[1]:+.4f} to the sideways speed")
    sides = [slip_left_out(table, side) for side in (0, 1)]
    print_scores(
        "slip terms, one row left out",
        table,
        np.column_stack((sides[0][0], sides[1][0], angle_left_out(table))),
    )
    for side, (mean, std) in enumerate(sides):
        within = np.mean(np.abs(mean - table.measured[:, side]) <= 2.0 * std)
        print(f"{OUTPUTS[side]}: {within:.1%} within 2 of the predicted deviations")
    print_scores(f"slip terms, {FOLDS} folds", table, held_out(table, by_terms, arguments.seed))
    try:
        print_scores(f"boosted trees, {FOLDS} folds", table, held_out(table, by_trees, arguments.seed))
    except ImportError:
        print("\n`pip install catboost` to have the boosted trees of the table's authors beside")


if __name__ == "__main__":
    main()
