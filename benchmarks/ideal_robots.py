# SPDX-License-Identifier: Apache-2.0
"""Does learning do harm? Robots that obey at once, with slip or a delay at most, against the baseline.

Ten robots of each kind are simulated without the core's actuator model: ideal ones, some with slip alone,
some with a delay alone. Each is learned by `auto` from its commands, with and without wheel speeds beside
them, and from its wheel speeds. Predictions are judged causally and on the second half: the model from the
measured pose, as the verdict does, and beside it as `evaluate` shows it, where the noise of the last poses is
averaged out of the start. A ratio to the kinematic baseline above 1 is harm; a model above 1.05 fails.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

import slipwise
from slipwise import _core
from slipwise.calibration.judgement import judgement_of
from slipwise.calibration.learner import STRUCTURES
from slipwise.logs.log import Inputs, Log, Source
from slipwise_sim.known_robot import KnownRobot, known_run

KINDS = ("ideal", "slip", "delay")
SEEDS = 10
SECONDS, FIRST, COMMAND_PERIOD = 240.0, 2.0, 0.05  # s
HELD = (0.5, 4.0)  # s that a command lasts
SPEEDS, YAW_RATES = (-0.5, 1.5), (-0.8, 0.8)  # m/s, rad/s
POSE_STD_XY, POSE_STD_YAW = (0.002, 0.02), (0.001, 0.01)  # m, rad: drawn evenly in the logarithm
SLIP_PSD = (0.0, 1e-5, 1e-4)  # m^2/s and rad^2/s: one of these
DELAYS = (0.05, 0.4)  # s
FORWARD_SLIP, YAW_SLIP = (-0.1, 0.02), (-0.5, -0.05)
AT_ONCE = 1e-9  # s, a lag that is none
HORIZONS = (2.0, 5.0)  # s
WORST = 1.05
WAYS = (("command", False), ("command", True), ("wheel", True))  # input, and whether wheel speeds are logged


@dataclass(frozen=True)
class Case:
    """One robot, learned in one way."""

    kind: str
    seed: int
    input: str
    wheels: bool


@dataclass(frozen=True)
class Harm:
    """How much worse than the kinematic baseline: ratios of mean errors."""

    case: Case
    position: float  # the worst of all horizons, of the model from the measured pose
    heading: float
    evaluated_position: float  # the same from where the last poses say together
    evaluated_heading: float
    structure: str  # that predicted in the end


def robot(kind: str, seed: int) -> KnownRobot:
    """Draw a robot of one kind."""
    rng = np.random.default_rng((seed, 17))
    pose = tuple(float(np.exp(rng.uniform(*np.log(span)))) for span in (POSE_STD_XY, POSE_STD_YAW))
    psd = float(rng.choice(SLIP_PSD))
    slip = (float(rng.uniform(*FORWARD_SLIP)), float(rng.uniform(*YAW_SLIP)))
    delay = float(rng.uniform(*DELAYS))
    other = delay if seed % 2 else float(rng.uniform(*DELAYS))
    ideal = KnownRobot(
        lag=(AT_ONCE, AT_ONCE), delay=(0.0, 0.0), pose_std=(pose[0], pose[1]), slip_psd=(psd, psd, psd)
    )
    if kind == "slip":
        return replace(ideal, basis=_core.named_basis("edd-2"), slip=slip)
    return replace(ideal, delay=(delay, other)) if kind == "delay" else ideal


def log_of(case: Case) -> Log:
    """Drive the robot by held random commands."""
    rng = np.random.default_rng((case.seed, 18))
    t = np.arange(0.0, SECONDS, COMMAND_PERIOD)
    begins = np.concatenate(([0.0], np.cumsum(rng.uniform(*HELD, round(SECONDS / HELD[0])))))
    at = np.searchsorted(begins, t + 1e-9, side="right") - 1
    v, omega = rng.uniform(*SPEEDS, len(begins))[at], rng.uniform(*YAW_RATES, len(begins))[at]
    commands = Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega)
    run = known_run(robot(case.kind, case.seed), commands, (FIRST, SECONDS), random=rng)
    source = Source(f"{case.kind}-{case.seed}", "0", "simulated", len(t))
    return Log((run if case.wheels else replace(run, wheels=None),), (source,), (), ())


def harm(case: Case) -> Harm:
    """Learn one robot and compare with the baseline."""
    options = slipwise.EvaluationOptions(horizons=HORIZONS, methods=("none", "auto"))
    evaluation = slipwise.evaluate(log_of(case), input=case.input, options=options)
    scores = [score for score in evaluation.scores if score.method == "auto"]
    none, auto = ([p for p in evaluation.predictions if p.method == name] for name in options.methods or ())
    judged = [judgement_of(learned, plain) for learned, plain in zip(auto, none, strict=True)]
    return Harm(
        case,
        max(each.position_ratio[0] for each in judged),
        max(each.heading_ratio[0] for each in judged),
        max(score.position_ratio[0] for score in scores),
        max(score.heading_ratio[0] for score in scores),
        STRUCTURES[auto[-1].structure[-1]],
    )


def cases(kinds: tuple[str, ...], seeds: int) -> Iterator[Case]:
    """Return all robots with all ways to learn them."""
    for kind in kinds:
        for name, wheels in WAYS:
            yield from (Case(kind, seed, name, wheels) for seed in range(seeds))


def print_table(found: list[Harm]) -> float:
    """Print the worst of each kind and way, and return the worst of all."""
    print("                              worst model         as evaluated     models")
    print("kind   learned from         position  heading  position  heading  above 1.05  in the end")
    worst = 0.0
    for kind in KINDS:
        for name, wheels in WAYS:
            group = [h for h in found if (h.case.kind, h.case.input, h.case.wheels) == (kind, name, wheels)]
            if not group:
                continue
            ratios = [(h.position, h.heading, h.evaluated_position, h.evaluated_heading) for h in group]
            most = np.max(ratios, axis=0).tolist()
            harmed = sum(max(h.position, h.heading) > WORST for h in group)
            structures = [h.structure for h in group]
            ends = ", ".join(f"{structures.count(s)} {s}" for s in sorted(set(structures)))
            way = "wheel speeds" if name == "wheel" else f"commands{' and wheels' if wheels else ''}"
            row = "".join(f"{value:9.3f}" for value in most)
            print(f"{kind:6s} {way:19s} {row} {harmed:8d}/{len(group)}  {ends}")
            worst = max(worst, *most[:2])
    return worst


def main() -> int:
    """Run the benchmark; 1 where learning does harm."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures here")
    parser.add_argument("--seeds", type=int, default=SEEDS, help="robots of each kind")
    parser.add_argument("--processes", type=int, default=None, help="all cores where not given")
    arguments = parser.parse_args()
    with ProcessPoolExecutor(arguments.processes) as pool:
        found = list(pool.map(harm, cases(KINDS, arguments.seeds)))
    worst = print_table(found)
    print(f"\nworst model: {worst:.3f} of the error of the kinematic baseline, allowed: {WORST}")
    if arguments.json:
        text = json.dumps([asdict(each) for each in found], indent=1)
        arguments.json.write_text(f"{text}\n", encoding="utf-8")
    return int(worst > WORST)


if __name__ == "__main__":
    sys.exit(main())
