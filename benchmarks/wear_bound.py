# SPDX-License-Identifier: Apache-2.0
"""How often a wheel that wears is found by `slipwise fleet`, beside the most that any test could find.

    python benchmarks/wear_bound.py --fleets 300

Eight vehicles drive a log a day for 30 days; the first one's wheel wears evenly by 1 %. A log's estimate is
normal about the truth with a standard deviation that it states, and every vehicle has a level of its own
that nobody knows. Where nothing else scatters, the slope of least squares is all that the logs say of wear,
and by Neyman and Pearson no test finds it more often than the one that takes slopes beyond a limit. The
limit is that at which 5 % of fleets without wear raise an alarm. The tests of `findings_of` share these 5 %
with those for odd robots, have to find scatter out themselves - also one that lasts for several logs (0.7
of it from one to the next, as by the ground), or is common to all vehicles (a season) -, and look for
random walks, too.

A last table has the share of fleets without wear that alarm of wear, by robots and logs.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from slipwise.fleet import findings_of

Floats = NDArray[np.float64]

VEHICLES, DAYS = 8, 30
WEAR = 0.01  # over the thirty days
FALSE_ALARMS = 0.05  # of fleets in which nothing happens
BETWEEN = 0.02  # standard deviation of vehicles
SECONDS = 86400.0  # of a day
KEPT = 0.7  # of scatter that lasts, from one log to the next
KINDS = ("independent", "ground", "season")
BEYOND = 3.0  # scatter, in units of what logs say
SHAPES = tuple((vehicles, days) for vehicles in (3, 5, 10) for days in (6, 12, 25))


@dataclass(frozen=True)
class Fleet:
    """How many robots drive for how many days, and how their logs scatter beyond what they say."""

    vehicles: int = VEHICLES
    days: int = DAYS
    kind: str = "independent"
    size: float = 0.0  # of that scatter, in units of what a log says


DAILY = Fleet()


def best(sigma: float, *, direction_known: bool) -> float:
    """Return the chance of the best test to find the wear, where a log is good to `sigma`."""
    normal = NormalDist()
    off = sigma / float(np.sqrt(np.sum((np.arange(DAYS) - 0.5 * (DAYS - 1)) ** 2)))  # of the slope
    each = 1.0 - (1.0 - FALSE_ALARMS) ** (1.0 / VEHICLES)
    limit = normal.inv_cdf(1.0 - (each if direction_known else 0.5 * each))
    size = WEAR / DAYS / off
    wrong_way = 0.0 if direction_known else normal.cdf(-limit - size)
    return 1.0 - normal.cdf(limit - size) + wrong_way


def scatter_of(random: np.random.Generator, fleet: Fleet) -> Floats:
    """Return scatter of one standard deviation, [V, N]."""
    days = fleet.days
    drawn = random.standard_normal((fleet.vehicles, days))
    if fleet.kind == "season":
        year = random.uniform(0.7, 4.0) * days
        wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * (np.arange(days) / year + random.uniform()))
        return np.tile(wave, (fleet.vehicles, 1))
    if fleet.kind == "ground":
        for k in range(1, days):
            drawn[:, k] = KEPT * drawn[:, k - 1] + np.sqrt(1.0 - KEPT**2) * drawn[:, k]
    return drawn


def alarms_of(
    random: np.random.Generator, sigma: float, wear: float, fleet: Fleet = DAILY
) -> set[tuple[str, str]]:
    """Return vehicle and kind of the alarms in one fleet, whose first vehicle wears.

    Args:
        random: draws the fleet.
        sigma: what a log is good to, as it says.
        wear: of the first vehicle, over all days.
        fleet: its robots, logs and scatter.
    """
    vehicles, count = fleet.vehicles, fleet.days
    days = np.arange(count, dtype=np.float64)
    names = [f"robot-{k}" for k in range(vehicles)]
    level = random.normal(-0.1, BETWEEN, (vehicles, 1))
    scatter = fleet.size * scatter_of(random, fleet) if fleet.size > 0.0 else 0.0
    values = level + sigma * (random.standard_normal((vehicles, count)) + scatter)
    values[0] += wear * days / count
    table = {
        "vehicle": np.repeat(names, count),
        "parameter": np.full(values.size, "lon.V"),
        "unit": np.full(values.size, "-"),
        "value": values.ravel(),
        "std": np.full(values.size, sigma),
        "start": np.tile(1.7e9 + SECONDS * days, vehicles),
        "distance": np.full(values.size, 500.0),
    }
    (found,) = findings_of(table)
    return {(finding.vehicle, finding.kind) for finding in found.findings if finding.alarm}


def false_wear(random: np.random.Generator, sigma: float, fleet: Fleet, fleets: int) -> float:
    """Return the share of so many fleets without wear in which a vehicle seems to wear."""
    drawn = (alarms_of(random, sigma, 0.0, fleet) for _ in range(fleets))
    return float(np.mean([any(kind == "drift" for _, kind in alarms) for alarms in drawn]))


def main() -> int:
    """Print the share of fleets in which the wear is found."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--fleets", type=int, default=200)
    parser.add_argument("--noise", type=float, nargs="+", default=[0.003, 0.004, 0.005])
    asked = parser.parse_args()
    print("noise  found  quiet fleets that alarm  best, either direction  best, known direction")
    for sigma in asked.noise:
        random = np.random.default_rng(1)
        worn = [("robot-0", "drift") in alarms_of(random, sigma, WEAR) for _ in range(asked.fleets)]
        quiet = [bool(alarms_of(random, sigma, 0.0)) for _ in range(asked.fleets)]
        bounds = (best(sigma, direction_known=known) for known in (False, True))
        print(f"{sigma:g}  {np.mean(worn):.3f}  {np.mean(quiet):.3f}  ", *(f"{each:.3f}" for each in bounds))
    print("scatter of three times what logs say: found by wear of 1 %, 3 %, 5 %; quiet fleets that alarm")
    for kind in KINDS:
        random, fleet = np.random.default_rng(1), Fleet(kind=kind, size=BEYOND)
        found = [
            np.mean([("robot-0", "drift") in alarms_of(random, 0.004, w, fleet) for _ in range(asked.fleets)])
            for w in (0.01, 0.03, 0.05)
        ]
        quiet = [bool(alarms_of(random, 0.004, 0.0, fleet)) for _ in range(asked.fleets)]
        print(kind, *(f"{each:.3f}" for each in found), f"{np.mean(quiet):.3f}")
    print("fleets without wear that alarm of wear: robots, logs;", *KINDS)
    for vehicles, count in SHAPES:
        random = np.random.default_rng(1)
        shapes = [Fleet(vehicles, count, kind, BEYOND) for kind in KINDS]
        false = [false_wear(random, 0.004, fleet, asked.fleets) for fleet in shapes]
        print(vehicles, count, *(f"{each:.3f}" for each in false))
    return 0


if __name__ == "__main__":
    sys.exit(main())
