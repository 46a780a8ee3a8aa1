# SPDX-License-Identifier: Apache-2.0
"""How true the limits found in wheel speeds are: simulated drives of known limits, and dull ones.

Steps of speed and yaw rate through an actuator of known dead-band, saturation and slew rates, of
the sides or of speed and yaw rate, with white noise on the wheel speeds. Counted is how often each limit is
found, how often the truth lies within 3 of its reported standard deviations, and how often a limit is found
that is not there.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python" / "tests"))

from limited_drives import CHANNELS, FREE, SIDES, TRACK, search

from slipwise import _core
from slipwise.calibration.judge import limits_advice
from slipwise_sim import dull_drive, steps_drive

SECONDS = 120.0
FAR = _core.AxisLimits(0.0, 4.0, 30.0, 30.0)  # beyond what a dull drive shows
CASES = {
    "sides": (SIDES, steps_drive),
    "channels": (CHANNELS, steps_drive),
    "no limits": (_core.CommandLimits(FREE, FREE, FREE, TRACK, 1.0, 1.0), steps_drive),
    "dull": (_core.CommandLimits(FREE, FREE, FAR, TRACK, 1.0, 1.0), dull_drive),
}


@dataclass(frozen=True)
class Found:
    """One limit of one drive."""

    name: str
    value: float
    std: float
    truth: float


@dataclass(frozen=True)
class Drive:
    """What was found in one drive."""

    case: str
    seed: int
    found: list[Found]
    advice: tuple[str, ...]


def true_value(limits: _core.CommandLimits, found: _core.FoundLimit) -> float:
    """Return the truth of a limit that was found."""
    axis = {_core.LimitedAxis.Speed: limits.speed, _core.LimitedAxis.YawRate: limits.yaw_rate}.get(
        found.axis, limits.side
    )
    kinds = _core.LimitKind
    return {
        kinds.DeadBand: axis.dead_band,
        kinds.Saturation: axis.saturation,
        kinds.SlewRateUp: axis.slew_rate_up,
        kinds.SlewRateDown: axis.slew_rate_down,
    }[found.kind]


def one(case: str, seed: int) -> Drive:
    """Simulate and search one drive."""
    limits, commands = CASES[case]
    result = search(limits, commands(seed, SECONDS), seed)
    found = [
        Found(f"{f.axis.name} {f.kind.name}", f.value, f.std, true_value(limits, f)) for f in result.found
    ]
    return Drive(case, seed, found, limits_advice(result))


def print_case(case: str, drives: list[Drive]) -> None:
    """Print how often each limit was found, and how true its standard deviation is."""
    silent = sum(not drive.found and len(drive.advice) == 4 for drive in drives)
    print(f"\n== {case}: {len(drives)} drives of {SECONDS:g} s; {silent} say that no limit shows ==\n")
    found = [f for drive in drives for f in drive.found]
    for name in sorted({f.name for f in found}):
        mine = [f for f in found if f.name == name]
        z = np.array([(f.value - f.truth) / f.std for f in mine])
        print(
            f"{name:<22} found {len(mine):>4}, within 3 sigma {int((np.abs(z) <= 3.0).sum()):>4},"
            f" rms z {np.sqrt(np.mean(z**2)):6.2f}, mean sigma {np.mean([f.std for f in mine]):.2g}"
        )


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--cases", default=",".join(CASES), help="of " + ", ".join(CASES))
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    arguments = parser.parse_args()
    drives: list[Drive] = []
    with ProcessPoolExecutor() as pool:
        for case in arguments.cases.split(","):
            seeds = range(1, arguments.seeds + 1)
            mine = list(pool.map(one, [case] * len(seeds), seeds, chunksize=5))
            print_case(case, mine)
            drives += mine
    if arguments.json:
        content = json.dumps([asdict(drive) for drive in drives], indent=1)
        arguments.json.write_text(content + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
