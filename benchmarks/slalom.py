# SPDX-License-Identifier: Apache-2.0
"""Drives the simulated robot round a slalom by MPPI: plain, vendor and learned model, tuned alike."""

from __future__ import annotations

import argparse
import itertools
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import slipwise as sw
from slipwise.planning import (
    Controller,
    Motion,
    MppiOptions,
    ReferencePath,
    baseline_motion,
    learned_motions,
    vendor_motion,
)
from slipwise_sim import LandTamer, LiveRobot, Scenario, TyreLaw, World, simulate

SPEED = 1.2  # m/s
LENGTH, WAVE, SIDE = 30.0, 12.0, 1.5  # m along x, of one period, to each side
LONGEST = 60.0  # s, after which a drive is given up
LEARNED_FROM = 240.0  # s of another drive, with pose noise
ACROSS, SMOOTHNESS, NOISE = (
    (1.0, 5.0, 20.0, 80.0),
    (0.005, 0.05, 0.5),
    (0.4,),
)  # every method tries all of these


@dataclass(frozen=True)
class Drive:
    """How one drive went."""

    method: str
    across: float
    smoothness: float
    noise: float
    rms: float  # m of the cross-track error
    worst: float  # m
    seconds: float  # until the end of the slalom
    finished: bool


def slalom() -> np.ndarray:
    """Return the reference's points [N, 2]: a sine whose width grows over the first metres."""
    x = np.arange(0.0, LENGTH + 0.05, 0.1)
    return np.column_stack((x, SIDE * np.sin(2.0 * np.pi * x / WAVE) * np.clip(x / 3.0, 0.0, 1.0)))


def drive(method: str, motions: list[Motion], options: MppiOptions) -> Drive:
    """Drive the slalom once."""
    robot = LiveRobot(World(LandTamer(), "tyre-force", TyreLaw()), period=options.period)
    controller = Controller(motions, ReferencePath(slalom(), SPEED), options=options)
    state, errors = robot.state(), []
    while controller.reference.progress < LENGTH - 2.0 and state.t < LONGEST:
        state = robot.tell(*controller.command(state.pose, state.drive))
        errors.append(controller.reference.nearest(state.pose[:2])[1])
    return Drive(
        method=method,
        across=options.across,
        smoothness=options.smoothness,
        noise=options.yaw_rate_std,
        rms=float(np.sqrt(np.mean(np.square(errors)))),
        worst=float(np.abs(errors).max()),
        seconds=state.t,
        finished=controller.reference.progress >= LENGTH - 2.0,
    )


def methods() -> dict[str, list[Motion]]:
    """Return what each method believes; the vendor's multiplier is the best constant for this terrain."""
    log = simulate(Scenario(duration=LEARNED_FROM), seed=5).log
    constant = sw.calibrate(log, input="command", basis="edd-2").model
    turn = {p.name: p.value for p in constant.content.parameters}["ang.w"]
    learned = sw.calibrate(log, input="command").model
    return {
        "plain": [baseline_motion()],
        "vendor": [vendor_motion(1.0 / (1.0 + turn))],
        "learned": learned_motions(learned),
    }


def main() -> int:
    """Print every drive and the best of each method."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one setting for each method")
    parser.add_argument("--json", type=Path, help="write all drives to this file")
    arguments = parser.parse_args()
    grid = [(20.0, 0.05, 0.4)] if arguments.quick else list(itertools.product(ACROSS, SMOOTHNESS, NOISE))
    print(f"Slalom of {LENGTH:g} m at {SPEED:g} m/s, {SIDE:g} m to each side; cross-track error [m]\n")
    print(f"{'method':8} {'across':>7} {'smooth':>7} {'noise':>6} {'rms':>7} {'worst':>7} {'time s':>7}")
    drives = []
    for method, motions in methods().items():
        for across, smoothness, noise in grid:
            options = MppiOptions(across=across, smoothness=smoothness, yaw_rate_std=noise)
            done = drive(method, motions, options)
            drives.append(done)
            end = f"{done.seconds:7.1f}" if done.finished else "  never"
            setting = f"{method:8} {across:7g} {smoothness:7g} {noise:6g}"
            print(f"{setting} {done.rms:7.3f} {done.worst:7.3f} {end}", flush=True)
    print("\nBest of each method")
    for method in dict.fromkeys(done.method for done in drives):
        best = min((d for d in drives if d.method == method), key=lambda d: (not d.finished, d.rms))
        finished = sum(d.finished for d in drives if d.method == method)
        print(
            f"{method:8} rms {best.rms:.3f} m, worst {best.worst:.3f} m; finished {finished} of {len(grid)}"
        )
    if arguments.json:
        arguments.json.write_text(json.dumps([d.__dict__ for d in drives], indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
