# SPDX-License-Identifier: Apache-2.0
"""What a fleet's prior gives a robot that the fleet has never seen: of real vehicles of a type, one left out.

    SLIPWISE_DATA=... python benchmarks/fleet_left_out.py --seconds 30 120

All logs of the other vehicles are learned and make a prior. Each log of the vehicle that is left out is
learned from its first seconds, with that prior and without it, and both models predict the rest of the log.
Vehicles are told apart by what is known of them: tyres, track and year. A prior takes two vehicles, so that a
type needs three. Logs whose poses jump serve others and are not judged.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from data_sets import SHORT_HORIZON, DataSet, data_sets, input_names, required_folder

import slipwise
from slipwise.calibration import Settings
from slipwise.calibration.from_prior import KnownFleet, calibrate_from
from slipwise.calibration.log_knowledge import LogKnowledge
from slipwise.errors import SlipwiseError
from slipwise.evaluation import EvaluationOptions
from slipwise.fleet import write_prior
from slipwise.logs import Log
from slipwise.logs.open_log import cut_to_span
from slipwise.models import Model

HUSKY = {
    "husky/tile_deflated_tyres": "Husky, deflated tyres, track 0.48 m",
    "husky/wetgrass_bad_poses": "Husky, track 0.54 m",
    "drive_test/husky": "Husky of 2023",
}
WARTHOG = {
    "warthog/": "Warthog",
    "warthog_windows/": "Warthog",  # the same one
    "drive_test/warthog": "Warthog of 2023",
}
TYPES = {"husky": HUSKY, "skid-steer": HUSKY | WARTHOG}
UNJUDGED = ("husky/wetgrass_bad_poses",)
MOST_LOGS = 6  # of a vehicle


@dataclass(frozen=True)
class Gain:
    """One log of a vehicle that the fleet had not seen."""

    vehicle: str
    log: str
    seconds: float  # learned from
    position: float  # error with the prior over that without, on the rest of the log
    heading: float
    left_away: bool  # the log spoke against the prior


def vehicle_of(name: str, members: dict[str, str]) -> str | None:
    """Return which vehicle of a type drove a log; None for one of another type."""
    return next((vehicle for start, vehicle in members.items() if name.startswith(start)), None)


def chosen_logs(sets: Sequence[DataSet], members: dict[str, str]) -> dict[str, list[DataSet]]:
    """Return a few logs of each vehicle of a type, evenly over their names."""
    logs: dict[str, list[DataSet]] = {}
    for data in sets:
        vehicle = vehicle_of(data.name, members)
        if vehicle is not None:
            logs.setdefault(vehicle, []).append(data)
    return {vehicle: all_of[:: -(-len(all_of) // MOST_LOGS)] for vehicle, all_of in logs.items()}


def errors_on(log: Log, input_name: str, model: Model) -> tuple[float, float]:
    """Return the mean errors [m, rad] of a finished model on a log."""
    options = EvaluationOptions(horizons=(SHORT_HORIZON,), methods=("model",), model=model)
    found = slipwise.evaluate(log, input=input_name, options=options)
    (predictions,) = [each for each in found.predictions if each.method == "model"]
    return float(predictions.position_error.mean()), float(predictions.heading_error.mean())


def gains(logs: dict[str, list[DataSet]], input_name: str, spans: Sequence[float]) -> Iterator[Gain]:
    """Yield what the others' prior gives each log of each vehicle."""
    opened = {data.name: slipwise.open_log(data.path) for all_of in logs.values() for data in all_of}
    known: dict[str, list[LogKnowledge]] = {}
    for vehicle, all_of in logs.items():
        having = [data for data in all_of if input_name in input_names(opened[data.name])]
        learned = [calibrate_from(opened[data.name], None, input=input_name)[1] for data in having]
        known[vehicle] = [each for each in learned if each is not None]
    for vehicle, all_of in logs.items():
        others = [(other, each) for other in logs if other != vehicle for each in known[other]]
        with tempfile.TemporaryDirectory() as folder:
            prior = KnownFleet.load(write_prior(Path(folder) / "prior.yaml", (), others))
            for data in all_of:
                if data.name in UNJUDGED:
                    continue
                for seconds in spans:
                    try:
                        yield _gain(vehicle, data.name, opened[data.name], (input_name, seconds), prior)
                    except SlipwiseError as problem:
                        print(f"{data.name}, {seconds:g} s: {problem}", flush=True)


def _gain(vehicle: str, name: str, log: Log, asked: tuple[str, float], prior: KnownFleet) -> Gain:
    input_name, seconds = asked
    first, rest = cut_to_span(log, None, seconds), cut_to_span(log, seconds, None)
    begun = calibrate_from(first, prior, input=input_name)[0]
    fresh = calibrate_from(first, None, input=input_name, settings=Settings())[0]
    errors = np.array([errors_on(rest, input_name, each.model) for each in (begun, fresh)])
    position, heading = (errors[0] / errors[1]).tolist()
    left_away = any("was left away" in note for note in begun.notes)
    return Gain(vehicle, name, seconds, position, heading, left_away)


def main() -> int:
    """Print a line per log, and the geometric means of each vehicle."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--type", choices=TYPES, default="skid-steer")
    parser.add_argument("--input", choices=("command", "wheel"), default="command")
    parser.add_argument("--seconds", type=float, nargs="+", default=[30.0, 120.0])
    asked = parser.parse_args()
    logs = chosen_logs(data_sets(required_folder()), TYPES[asked.type])
    found = []
    for gain in gains(logs, asked.input, asked.seconds):
        found.append(gain)
        away = "  prior left away" if gain.left_away else ""
        ratios = f"{gain.position:7.2f}{gain.heading:7.2f}"
        print(f"{gain.vehicle:38}{gain.log:40}{gain.seconds:5.0f} s{ratios}{away}", flush=True)
    for seconds in asked.seconds:
        for vehicle in dict.fromkeys(gain.vehicle for gain in found):
            mine = [gain for gain in found if (gain.vehicle, gain.seconds) == (vehicle, seconds)]
            ratios = np.array([(gain.position, gain.heading) for gain in mine]).reshape(-1, 2)
            position, heading = np.exp(np.log(ratios).mean(axis=0)) if mine else (np.nan, np.nan)
            print(f"{seconds:g} s  {vehicle:38}{len(mine):3} logs  {position:.2f}  {heading:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
