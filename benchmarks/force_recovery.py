# SPDX-License-Identifier: Apache-2.0
"""A six-wheel vehicle in MuJoCo under a side wind, with a towed load, with a stuck wheel: is the force found?

What is true follows from the same drive without it: how much further the body moved per distance driven and
per angle turned. Slip is held against what is learned of that drive.

    python benchmarks/force_recovery.py --seeds 4
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipwise.calibration import Calibration, calibrate, make_settings
from slipwise.logs import Inputs
from slipwise_sim import Scenario, Simulation, simulate
from slipwise_sim.push import Push, StuckWheel

Floats = NDArray[np.float64]

PERIOD = 0.1  # s, of the commands
WIND = (0.0, 1500.0)  # N over the map, on 1000 kg
LOAD = (-1500.0, 0.0)  # N on the robot, from half of the drive on
_SPEEDS = ("vx", "vy", "omega")
SLIP = ("lon.V", "lat.w", "ang.w", "ang.V")  # that a force may bend


@dataclass(frozen=True)
class Case:
    """What pushes the vehicle, and how it is learned."""

    name: str
    frame: str
    settings: dict[str, float]
    pushed: Callable[[float], dict[str, Any]]  # of a scenario, by half of the drive's time [s]
    seconds: float = 180.0  # of the drive
    limps: bool = False  # it drives ahead in wide curves from half of the drive on


CASES = (
    Case("side wind", "world", {}, lambda _: {"push": Push(WIND, frame="world")}),
    Case("towed load", "body", {}, lambda half: {"push": Push(LOAD, start=half)}),
    Case(
        "stuck wheel",
        "body",
        {"time_constant": 300.0, "std": 0.05},
        lambda half: {"stuck": StuckWheel("l1", half)},
        seconds=240.0,
        limps=True,
    ),
)


@dataclass(frozen=True)
class Recovery:
    """What was learned of a drive."""

    names: tuple[str, ...]  # [F] of the force's parameters
    truth: Floats  # [F]
    found: Floats  # [F]
    std: Floats  # [F]
    bent: tuple[float, float]  # farthest slip parameter, in sigma: without the force, and with it
    error: tuple[float, float]  # m, held-out error: without the force, and with it
    sentence: str

    @property
    def z(self) -> Floats:
        """Errors of the force in sigma, [F]."""
        return (self.found - self.truth) / self.std


def shuttle(seed: int, seconds: float, one_way_after: float) -> Inputs:
    """Return straight legs of 3 s to 6 s and turns of 2 s to 4 s, either way; later ahead and gently."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, PERIOD)
    v, omega = np.zeros_like(t), np.zeros_like(t)
    row = 0
    while row < len(t):
        straight, turn = int(random.uniform(3.0, 6.0) / PERIOD), int(random.uniform(2.0, 4.0) / PERIOD)
        limps = bool(t[row] >= one_way_after)
        sign = 1.0 if limps else random.choice((-1.0, 1.0))
        v[row : row + straight] = sign * random.uniform(0.5, 1.6)
        row += straight
        v[row : row + turn] = sign * random.uniform(0.2, 1.2)
        sharpness = random.uniform(0.05, 0.15) if limps else random.uniform(0.2, 0.6)
        omega[row : row + turn] = random.choice((-1.0, 1.0)) * sharpness
        row += turn
    return Inputs(t=t, v=v, vy=np.zeros_like(v), omega=omega)


def drift(pushed: Simulation, plain: Simulation, frame: str, since: float) -> dict[str, float]:
    """What the push did from a time on: motion per |V| and |w| of the wheels, by the names of the terms."""
    k = pushed.truth.t >= since
    wheels = plain.log.runs[0].wheels
    assert wheels is not None
    v, w, one = np.abs(wheels.v[k]), np.abs(wheels.omega[k]), np.ones(int(k.sum()))
    cos, sin = np.cos(pushed.truth.yaw[k]), np.sin(pushed.truth.yaw[k])
    turned = {"": one} if frame == "body" else {"*cos(yaw)": cos, "*sin(yaw)": sin}
    terms = {f"abs({n}){text}": x * by for n, x in (("V", v), ("w", w)) for text, by in turned.items()}
    features = np.column_stack(tuple(terms.values()))

    moved = np.column_stack([(getattr(pushed.truth, of) - getattr(plain.truth, of))[k] for of in _SPEEDS])
    fitted = np.linalg.lstsq(features, moved)[0]
    channels = ("lon", "lat", "ang") if frame == "body" else ("lon", "lat")  # wind turns no robot here
    return {
        f"{c}.{term}": float(fitted[i, j]) for j, c in enumerate(channels) for i, term in enumerate(terms)
    }


@cache
def without_push(seed: int, seconds: float, one_way_after: float) -> tuple[Inputs, Simulation, Calibration]:
    """Return commands, the drive that nothing pushes, and what is learned of it."""
    commands = shuttle(seed, seconds, one_way_after)
    plain = simulate(Scenario(duration=seconds, commands=commands), seed=seed)
    return commands, plain, calibrate(plain.log, input="wheel")


def recover(case: Case, seed: int) -> Recovery:
    """Drive with and without the push, learn with and without the force."""
    seconds, half = case.seconds, 0.5 * case.seconds
    commands, plain, free = without_push(seed, seconds, half if case.limps else np.inf)
    pushed = simulate(Scenario(duration=seconds, commands=commands, **case.pushed(half)), seed=seed)
    since = 5.0 if case.frame == "world" else half + 5.0
    truth = drift(pushed, plain, case.frame, since)
    without = calibrate(pushed.log, input="wheel")
    force = {"frame": case.frame, **case.settings}
    beside = calibrate(pushed.log, input="wheel", settings=make_settings({"body_force": force}))
    model = beside.model
    names = tuple(truth)
    return Recovery(
        names,
        np.array([truth[name] for name in names]),
        np.array([model[name].value for name in names]),
        np.array([model[name].std for name in names]),
        (farthest(without, free), farthest(beside, free)),
        (held_out(without), held_out(beside)),
        beside.verdict.force,
    )


def farthest(learned: Calibration, free: Calibration) -> float:
    """Return how far slip is from that of the drive without a push, in sigma: of the parameter most bent."""
    one, other = learned.model, free.model
    return max(
        abs(one[name].value - other[name].value) / float(np.hypot(one[name].std, other[name].std))
        for name in SLIP
        if name in one and name in other
    )


def held_out(learned: Calibration) -> float:
    """Return the held-out position error that the verdict states [m]."""
    figures = learned.model.content.verdict.held_out
    assert figures is not None
    return figures.position


def main() -> None:
    """Drive, learn and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=4, help="drives of each case")
    arguments = parser.parse_args()
    print("| case | seed | force, in sigma from the truth | slip bent, sigma | held-out error, m |")
    print("|---|---|---|---|---|")
    for case in CASES:
        for seed in range(3, 3 + arguments.seeds):
            got = recover(case, seed)
            worst = ", ".join(f"{name} {z:+.1f}" for name, z in zip(got.names, got.z, strict=True))
            bent, error = (f"{a:.{n}f} without, {b:.{n}f}" for (a, b), n in ((got.bent, 1), (got.error, 3)))
            print(f"| {case.name} | {seed} | {worst} | {bent} | {error} |", flush=True)
            print(f"    {got.sentence}", flush=True)


if __name__ == "__main__":
    main()
