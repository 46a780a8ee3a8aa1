# SPDX-License-Identifier: Apache-2.0
"""What designed drives teach beside uniform random and typical driving, and whether they stay inside.

Three tables: the worst prediction by the mathematics alone, on a finer grid than the design uses; a thousand
robots drawn from the prior per vehicle and area; and models learned in MuJoCo, whose physics is not ours.
Uniform random commands are the protocol of Baril et al. (DRIVE).
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from slipwise.calibration import calibrate
from slipwise.calibration.from_prior import KnownFleet
from slipwise.calibration.new_robot import new_robot_knowledge
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.excitation import (
    VEHICLES,
    CommandSpace,
    Excitation,
    ExcitationOptions,
    Knowledge,
    Move,
    command_inputs,
    design_drive,
    drawn_robots,
    lessons_of,
    prior_knowledge,
)
from slipwise.excitation.information import (
    PoseStd,
    WorstPrediction,
    information,
    move_jacobians,
    prediction_jacobians,
    prior_information,
)
from slipwise.excitation.moves import command_periods
from slipwise.excitation.robots import PERIOD
from slipwise.logs import Inputs, Log
from slipwise.models import Model
from slipwise_sim import Scenario, simulate

SPACE = CommandSpace(3.0, 2.0, 4.0)
COUNTS = (5, 10, 20)
JUDGED = 13  # levels of speed and yaw rate from zero to their limits
DRAWS = 200  # of random drives
SIGMA = 0.3  # of every term
STEP = 6.0  # s of a command in the uniform protocol
TEST_SECONDS = 120.0
NOISE = {"std_xy": 0.05, "std_yaw": 0.03}
Pairs = dict[str, dict[int, tuple[float, float]]]


def design_table() -> Pairs:
    """Return the worst yaw [rad] and position [m] after some moves of 2 s, by protocol."""
    by_fraction = prior_knowledge(SPACE, dynamics=False)
    flat = SIGMA**2 * np.eye(len(by_fraction.mean))
    priors = {"each term": replace(by_fraction, covariance=flat, spread=flat), "fraction": by_fraction}
    return {name: row for prior, knowledge in priors.items() for name, row in _rows(prior, knowledge).items()}


def _rows(prior: str, knowledge: Knowledge) -> Pairs:
    judge = WorstPrediction(prediction_jacobians(knowledge, SPACE.grid(JUDGED), 2.0))
    options = ExcitationOptions(area=None, pause=0.0, minutes=0.7, levels=9)
    grid = SPACE.grid(JUDGED)
    told = np.array([_told(knowledge, v, omega) for v, _, omega in grid.tolist()])
    start = prior_information(knowledge)
    designed = [_told(knowledge, m.v, m.omega) for m in design_drive(knowledge, SPACE, options).moves]
    v, _, omega = grid.T
    typical = np.flatnonzero((v >= 0.4) & (v <= 1.6) & (np.abs(omega) < 0.5))
    rows = {f"designed, {prior}": {n: judge.sigmas(start + np.sum(designed[:n], axis=0)) for n in COUNTS}}
    random = np.random.default_rng(0)
    for name, places in (("uniform", np.arange(len(grid))), ("typical", typical)):
        rows[f"{name}, {prior}"] = {}
        for n in COUNTS:
            drawn = [judge.sigmas(start + told[random.choice(places, n)].sum(axis=0)) for _ in range(DRAWS)]
            yaw, position = np.median(drawn, axis=0).tolist()
            rows[f"{name}, {prior}"][n] = yaw, position
    return rows


def _told(knowledge: Knowledge, v: float, omega: float) -> np.ndarray:
    return information(move_jacobians(knowledge, [Move(v, omega, 2.0, 0.0)])[0], PoseStd())


def area_table(side: float) -> dict[str, dict[str, float]]:
    """Return per vehicle how sure a minute makes it, and how far a thousand robots stay from the fence."""
    rows = {}
    for name, vehicle in VEHICLES.items():
        knowledge = prior_knowledge(vehicle.space)
        drive = design_drive(
            knowledge, vehicle.space, ExcitationOptions(area=(side, side), radius=vehicle.radius)
        )
        robots = drawn_robots(knowledge, 1000, seed=2026).paths(command_periods(drive.moves, PERIOD))
        rows[name] = _row(drive, robots)
    return rows


def fleet_table(file: Path, vehicle: str, sides: Sequence[float]) -> dict[str, dict[str, float]]:
    """Return the same by area, of a fleet's prior, and of a thousand robots drawn from it basis by basis."""
    prior, rows = KnownFleet.load(file), {}
    known = VEHICLES[vehicle]
    for side in sides:
        options = ExcitationOptions(area=(side, side), radius=known.radius)
        drive = design_drive(new_robot_knowledge(prior), known.space, options)
        robots = drawn_robots(drive.knowledge, 1000, seed=2026)
        rows[f"{vehicle}, {side:g} m"] = _row(drive, robots.paths(command_periods(drive.moves, PERIOD)))
    return rows


def _row(drive: Excitation, paths: np.ndarray) -> dict[str, float]:
    lessons, radius = lessons_of(drive), drive.options.radius
    (x, y), (width, depth) = drive.start, drive.options.area or (np.inf, np.inf)
    rooms = np.min(
        [
            x + paths[:, 0].min(axis=1),
            width - x - paths[:, 0].max(axis=1),
            y + paths[:, 1].min(axis=1),
            depth - y - paths[:, 1].max(axis=1),
        ],
        axis=0,
    )
    return {
        "moves": len(drive.moves),
        "seconds": drive.seconds,
        "fastest": max(abs(move.v) for move in drive.moves),
        "yaw before": lessons[0].yaw,
        "yaw after": lessons[-1].yaw,
        "position before": lessons[0].position,
        "position after": lessons[-1].position,
        "robots": len(paths),
        "robots outside": int(np.sum(rooms < radius)),
        "least room": float(rooms.min()) - radius,
    }


def physics_table(seeds: int) -> dict[str, dict[str, tuple[float, float]]]:
    """Return mean held-out errors after 2 s [m, rad] of models learned in MuJoCo, by test and drive."""
    space = VEHICLES["land-tamer"].space
    drives = {}
    for area in (None, (20.0, 20.0)):
        options = ExcitationOptions(area=area, minutes=1.0 / 3.0, hold=2.3, pause=0.0, radius=0.5, levels=4)
        name = "designed, 20 s" + ("" if area is None else f", {area[0]:g} m square")
        drives[name] = command_inputs(design_drive(prior_knowledge(space), space, options))
    tests = {
        "circles and random driving": simulate(Scenario(duration=TEST_SECONDS), seed=50).log,
        "random steps": simulate(
            Scenario(duration=TEST_SECONDS, commands=_steps(space, 1005, TEST_SECONDS, (1.0, 4.0))), seed=51
        ).log,
    }
    models: dict[str, Model] = {}
    for seed in range(seeds):
        for name, commands in drives.items():
            models[f"{name} #{seed}"] = _learned(commands, 20.0, seed)
        for seconds in (20.0, 60.0):
            commands = _steps(space, seed, seconds, (STEP, STEP))
            models[f"uniform, {seconds:g} s #{seed}"] = _learned(commands, seconds, seed)
    return {test: _errors(log, models) for test, log in tests.items()}


def _errors(log: Log, models: dict[str, Model]) -> dict[str, tuple[float, float]]:
    options = EvaluationOptions(horizons=(2.0,), methods=("none", *models), model=models)
    found: dict[str, list[tuple[float, float]]] = {}
    for score in evaluate(log, input="command", options=options).scores:
        name = score.method.split(" #")[0]
        found.setdefault(name, []).append((score.position.mean, score.heading.mean))
    return {name: tuple(np.mean(errors, axis=0).tolist()) for name, errors in found.items()}


def _steps(space: CommandSpace, seed: int, seconds: float, stay: tuple[float, float]) -> Inputs:
    """Return uniform random commands, each held for a uniform random time [s]."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 0.05)
    ends = np.cumsum(random.uniform(*stay, int(seconds / stay[0]) + 1))
    place = np.searchsorted(ends, t, side="right")
    v = random.uniform(-space.speed, space.speed, len(ends) + 1)[place]
    omega = random.uniform(-space.yaw_rate, space.yaw_rate, len(ends) + 1)[place]
    return Inputs(t=t, v=v, vy=np.zeros_like(t), omega=omega)


def _learned(commands: Inputs, seconds: float, seed: int) -> Model:
    recorded = simulate(Scenario(duration=seconds, commands=commands, **NOISE), seed=seed).log
    return calibrate(recorded, input="command").model


def main() -> None:
    """Print the tables; write them as JSON where asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--area", type=float, default=8.0, help="side of the square [m]")
    parser.add_argument("--seeds", type=int, default=6, help="of MuJoCo's drives")
    parser.add_argument(
        "--only", choices=("design", "area", "physics", "fleet"), help="make this table alone"
    )
    parser.add_argument("-o", "--output", type=Path, help="JSON file")
    parser.add_argument("--prior", type=Path, help="fleet.yaml of `slipwise fleet`: also its robots")
    parser.add_argument("--vehicle", default="warthog", help="of that fleet")
    parser.add_argument("--areas", type=float, nargs="+", default=[8.0, 20.0], help="for these [m]")
    given = parser.parse_args()
    makers = {
        "design": design_table,
        "area": lambda: area_table(given.area),
        "physics": lambda: physics_table(given.seeds),
    }
    if given.prior is not None:
        makers["fleet"] = lambda: fleet_table(given.prior, given.vehicle, given.areas)
    tables = {name: make() for name, make in makers.items() if given.only in (None, name)}
    for row, counts in tables.get("design", {}).items():
        cells = "  ".join(f"{n}: {yaw:.4f} rad {position:.3f} m" for n, (yaw, position) in counts.items())
        print(f"{row:<22} {cells}")
    for row, numbers in (tables.get("area", {}) | tables.get("fleet", {})).items():
        print(f"{row:<12}", "  ".join(f"{name} {value:.3g}" for name, value in numbers.items()))
    for test, methods in tables.get("physics", {}).items():
        for row, (position, heading) in methods.items():
            print(f"{test:<28} {row:<32} {position:.4f} m {heading:.4f} rad")
    if given.output is not None:
        given.output.write_text(json.dumps(tables, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
