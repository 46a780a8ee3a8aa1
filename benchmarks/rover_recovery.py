# SPDX-License-Identifier: Apache-2.0
"""How true is what is learned of simulated vehicles on steered wheels, and the twists that their joints tell.

Wheels are 5 % smaller than stated, creep, and roll further over stones than the chassis moves.
What is true is told by least squares over the noiseless motion of the same drive (MuJoCo).

    python benchmarks/rover_recovery.py --drives 10
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import slipwise as sw
from slipwise import _core
from slipwise.calibration import make_settings
from slipwise_sim.rover import RoughGround, Rover, swerve_base
from slipwise_sim.rover_drive import RoverDrive, drive_rover, mean_twists, rover_commands, true_slip

Floats = NDArray[np.float64]

SECONDS = 90.0  # of a drive
CHI2_MEDIAN, CHI2_MOST = 2.366, 14.156  # of three degrees of freedom: half, and three standard deviations


@dataclass(frozen=True)
class Case:
    """A vehicle on its ground, and what is learned of it."""

    name: str
    rover: Rover
    stones: int
    basis: str


CASES = (
    Case("swerve base, flat", swerve_base(), 0, "omni-8"),
    Case("rocker-bogie rover, flat", Rover(), 0, "full-linear-6"),
    Case("rocker-bogie rover, stones", Rover(), 600, "full-linear-6"),
)


@dataclass(frozen=True)
class Recovery:
    """What one drive told: [parameters] learned, as sure as it says, and true; and of the twists."""

    value: Floats
    std: Floats
    truth: Floats
    nees: Floats  # [N] of what the learned slip leaves of the twists, in their covariance
    agree: float  # sigma, how well the wheels agree


def drive_case(case: Case, seed: int, seconds: float = SECONDS) -> RoverDrive:
    """Drive once."""
    commands = rover_commands(case.rover, seconds, seed)
    return drive_rover(case.rover, commands, RoughGround(case.stones, height=0.05, seed=seed))


def recover(case: Case, seed: int, seconds: float = SECONDS) -> Recovery:
    """Drive once and learn from it; the ground stays the same, so changes of it are not looked for."""
    drive = drive_case(case, seed, seconds)
    truth = true_slip(drive, _core.named_basis(case.basis))
    settings = make_settings({"basis": case.basis, "change": {"branches": False}})
    model = sw.calibrate(drive.log(seed=seed), input="wheel", settings=settings).model
    nees, agree = twist_nees(drive, case, truth)
    return Recovery(
        np.array([model[name].value for name in truth]),
        np.array([model[name].std for name in truth]),
        np.array(list(truth.values())),
        nees,
        agree,
    )


def twist_nees(drive: RoverDrive, case: Case, slip: dict[str, float]) -> tuple[Floats, float]:
    """Return the NEES of each twist less its slip, and how well the wheels agree [sigma]."""
    stated = drive.rover.description()
    layout = stated.layout
    assert layout is not None
    speed = np.column_stack([drive.readings[f"wheel_{wheel.name}"] for wheel in stated.wheels])
    still = np.zeros(len(speed))
    steering = np.column_stack([drive.readings.get(f"steer_{wheel.name}", still) for wheel in stated.wheels])
    rows, covariances = layout.twists(speed, steering, np.zeros((0, 2)), np.zeros((0, len(stated.wheels))))
    twists, covariance = rows[:-1, :3], np.asarray(covariances)[:-1].reshape(-1, 3, 3)
    basis, alpha = _core.named_basis(case.basis), np.array(list(slip.values()))
    slipped = np.array(
        [_core.slip_rate(basis, alpha, _core.SlipState(v, w, 0.0, 0.0, vy)) for v, vy, w in twists.tolist()]
    )
    error = mean_twists(drive.truth) - twists - slipped
    nees = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error)
    return nees, float(np.sqrt(rows[:, 3].sum() / rows[:, 4].sum()))


def print_case(case: Case, drives: list[Recovery]) -> None:
    """Print what was learned beside what is true."""
    value, std, truth = (np.array([getattr(d, field) for d in drives]) for field in ("value", "std", "truth"))
    z = (value - truth) / std
    basis = _core.named_basis(case.basis)
    names = [f"{c}.{term}" for c in ("lon", "lat", "ang") for term in getattr(basis, c)]
    print(f"\n{case.name}, {len(drives)} drives of {SECONDS:g} s\n")
    print("| parameter | learned | sigma | true | rms z | within 3 sigma |\n|---|---|---|---|---|---|")
    for k, name in enumerate(names):
        means = f"{value[:, k].mean():.4f} | {std[:, k].mean():.4f} | {truth[:, k].mean():.4f}"
        print(f"| {name} | {means} | {np.sqrt(np.mean(z[:, k] ** 2)):.2f} | {np.sum(np.abs(z[:, k]) < 3)} |")
    nees = np.concatenate([d.nees for d in drives])
    print(
        f"\ntwists: wheels agree to {np.mean([d.agree for d in drives]):.2f} sigma;"
        f" median NEES over its own {np.median(nees) / CHI2_MEDIAN:.2f},"
        f" {100.0 * np.mean(nees < CHI2_MOST):.1f} of 100 within three standard deviations"
    )


def main() -> None:
    """Read the options and print a table for each vehicle."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--drives", type=int, default=10)
    drives = parser.parse_args().drives
    for case in CASES:
        print_case(case, [recover(case, seed) for seed in range(1, drives + 1)])


if __name__ == "__main__":
    main()
