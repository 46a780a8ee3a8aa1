# SPDX-License-Identifier: Apache-2.0
"""How soon a change of terrain is found, and how often one is found where there is none.

False alarms are counted on simulated drives over one terrain, with white, heavy-tailed and coloured
noise. Steps (yaw slip times 1.5 and times 1.25) are simulated with rigid-body physics; they can show only
while the robot turns, so that windows are counted from the first that turns by at least 0.2 rad/s. From
commands the actuator is learned along with the slip, without the wheel speeds that the log has beside them.
The real logs, where there are any, are counted too.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from data_sets import data_folder, data_sets, input_names
from numpy.typing import NDArray
from simulated_log import RATE, simulated_log

import slipwise
from slipwise import _core
from slipwise.calibration.calibrate import learning_windows
from slipwise.calibration.prepared_run import WindowSet, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.logs import Log
from slipwise_sim import Scenario, TerrainChange, TyreLaw, simulate
from slipwise_thesis.estimators import learned_parts

Floats = NDArray[np.float64]

SLIP_STD = np.array([0.03, 0.03, 0.04])  # m/s, m/s, rad/s, of heavy-tailed and the slip disturbance
SLIP_PSD = np.array([4e-4, 4e-4, 1e-4])  # m^2/s, m^2/s, rad^2/s, of white slip
COLOUR_SECONDS, DRAW_SECONDS, DEGREES = 3.0, 1.0, 3
OTHER_GROUNDS = {  # yaw slip over that of the first terrain, -0.37
    1.5: TyreLaw(slip_stiffness=7.0, cornering_stiffness=8.5),
    1.25: TyreLaw(slip_stiffness=9.0, cornering_stiffness=7.6),
}
TURNING = 0.2  # rad/s


@dataclass(frozen=True)
class Count:
    """Alarms on one kind of terrain."""

    name: str
    windows: int
    alarms: int


def white(count: int, rng: np.random.Generator) -> Floats:
    """Slip rates that are new at every step."""
    return np.asarray(rng.standard_normal((count, 3)) * np.sqrt(SLIP_PSD * RATE))


def heavy_tailed(count: int, rng: np.random.Generator) -> Floats:
    """Slip rates of a Student-t with 3 degrees of freedom, held for a second each."""
    held = round(DRAW_SECONDS * RATE)
    draws = rng.standard_t(DEGREES, (count // held + 1, 3)) * np.sqrt((DEGREES - 2) / DEGREES)
    return np.asarray(np.repeat(draws, held, axis=0)[:count] * SLIP_STD)


def coloured(count: int, rng: np.random.Generator) -> Floats:
    """Slip rates that last for seconds (Gauss-Markov)."""
    keep = np.exp(-1.0 / (RATE * COLOUR_SECONDS))
    slip, now = np.empty((count, 3)), np.zeros(3)
    for i, draw in enumerate(rng.standard_normal((count, 3)) * np.sqrt(1.0 - keep**2)):
        now = keep * now + draw
        slip[i] = now
    return slip * SLIP_STD


NOISES = {"white": white, "heavy-tailed": heavy_tailed, "coloured": coloured}


def tests_of(log: Log, input_name: str) -> tuple[WindowSet, list[_core.SlipChange]]:
    """Learn a log causally by `auto`; return its windows and their tests for a change."""
    windows = learning_windows(prepare_run(log, input_name), input_name, Settings())
    settings, tests = Settings(), []
    dynamics, offset = learned_parts(settings, input_name)
    filters = (settings.filter_settings(), _core.ModelAverageSettings())
    average = _core.ModelAverage("auto", settings.bases(), dynamics, offset, False, *filters)
    for i in range(len(windows)):
        average.learn(windows.input_history(i), windows.segments[i])
        tests.append(average.change)
    return windows, tests


def count_simulated(job: tuple[str, int, float]) -> Count:
    """Count the alarms of one drive over one terrain: noise, seed, minutes."""
    noise, seed, minutes = job
    log = simulated_log(minutes, seed=seed, slip_noise=NOISES[noise])
    _, tests = tests_of(log, "wheel")
    return Count(noise, len(tests), sum(test.alarm for test in tests))


def windows_until_found(job: tuple[int, str, float]) -> int | None:
    """Return after how many turning windows a step is found, None where it is not: seed, input, step."""
    seed, input_name, step = job
    at = 75.0 + 7.0 * (seed % 4)
    log = simulate(Scenario(duration=at + 45.0, change=TerrainChange(at, OTHER_GROUNDS[step])), seed=seed).log
    windows, tests = tests_of(log, input_name)
    wheels = log.runs[0].wheels
    if wheels is None:
        return None
    turning = [
        i
        for i in range(len(windows))
        if windows.start[i] >= at - 1e-6
        and np.abs(wheels.omega[(wheels.t >= windows.start[i]) & (wheels.t < windows.end[i])]).mean()
        > TURNING
    ]
    found = [i for i, test in enumerate(tests) if test.alarm and windows.end[i] > at]
    return sum(i <= found[0] for i in turning) if found and turning else None


def count_real(path: Path) -> list[tuple[str, Count]]:
    """Count the alarms of one real log with every input that it has."""
    log = slipwise.open_log(path)
    counts = []
    for name in input_names(log):
        windows, tests = tests_of(log, name)
        at = [
            f"{windows.end[i]:.1f} s of run {windows.position[i]}"
            for i, test in enumerate(tests)
            if test.alarm
        ]
        label = f"{path.parent.name}/{path.name.removesuffix('.csv.gz')} {name}"
        counts.append((", ".join(at), Count(label, len(tests), len(at))))
    return counts


def print_counts(counts: list[Count]) -> None:
    """Print the rate of each kind."""
    for name in dict.fromkeys(c.name for c in counts):
        windows = sum(c.windows for c in counts if c.name == name)
        alarms = sum(c.alarms for c in counts if c.name == name)
        print(f"{name:14} {windows:7} windows {alarms:4} alarms, {1000.0 * alarms / windows:.2f} per 1000")


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument("--quick", action="store_true", help="a tenth of the drives")
    arguments = parser.parse_args()
    drives = 1 if arguments.quick else 10
    folder = data_folder()
    with ProcessPoolExecutor() as pool:
        jobs = [(noise, seed, 34.0) for noise in NOISES for seed in range(drives)]
        counts = list(pool.map(count_simulated, jobs))
        steps = {
            f"{name} x{step}": list(
                pool.map(windows_until_found, [(seed, name, step) for seed in range(2 * drives)])
            )
            for step in OTHER_GROUNDS
            for name in ("wheel", "command")
        }
        real = [
            r
            for part in pool.map(count_real, [d.path for d in data_sets(folder)] if folder else [])
            for r in part
        ]
    print("One terrain, simulated:\n")
    print_counts(counts)
    print("\nSteps of yaw slip, simulated: windows from the first that turns until it is found\n")
    for name, found in steps.items():
        soon = sum(f is not None and f <= 3 for f in found)
        print(f"{name:13} {soon} of {len(found)} within 3: {['-' if f is None else f for f in found]}")
    if real:
        print("\nReal logs:\n")
        for where, count in (r for r in real if r[1].alarms):
            print(f"{count.name:44} {count.windows:5} windows {count.alarms:3} alarms: {where}")
        print_counts([Count("all", c.windows, c.alarms) for _, c in real])
    if arguments.json:
        content = {
            "one_ground": [asdict(c) for c in counts],
            "steps": steps,
            "real": [asdict(c) for _, c in real],
        }
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
