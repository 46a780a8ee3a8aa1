# SPDX-License-Identifier: Apache-2.0
"""Surfaces that come back: real sequences of a Warthog on three grounds, and simulated ones.

The Warthog's window sets (SLIPWISE_DATA) are driven in every order of the three, twice over: the second
time the same logs, or others of the same ground where there are some; with their column `terrain` as
labels, and without. Errors of the first ten windows of a visit are divided by those of a learner that
starts from nothing on the log ("restart"), by the mean error of its second half ("late"), and by that late
error times how much harder the kinematic baseline finds the first ten windows ("as hard"). The oracle
beside them is the model of the whole log, which has seen the windows that it predicts.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from data_sets import FEW, SHORT_HORIZON, data_folder, data_sets, input_names
from numpy.typing import NDArray
from surface_visits import FIRST, NOISES, coverage, labelled_visits, oracle_right, simulated_visits

import slipwise
from slipwise.calibration import calibrate
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.learned_sequence import learn_sequence
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import PreparedRun, prepare_run
from slipwise.calibration.settings import Settings
from slipwise.evaluation import EvaluationOptions, evaluate
from slipwise.logs import Log

Floats = NDArray[np.float64]
Drive = tuple[PreparedRun, ...]

GROUNDS = {  # first visit, second visit to another log
    "asphalt": ("asphalt_8_7_11h30s30", "asphalt_9_20_9h9s5"),
    "gravel": ("gravel_8_6_11h37s32", "gravel_8_6_11h37s32"),
    "sand": ("sand_9_25_14h13s47", "sand_9_25_14h32s32"),
}


@dataclass(frozen=True)
class Visit:
    """One visit of a real sequence; errors are pairs of position [m] and heading [rad]."""

    order: str
    log: str
    second: bool
    surface: str
    first: tuple[float, float]
    to_restart: tuple[float, float]  # first ten windows, over those of a learner that starts from nothing
    to_late: tuple[float, float]  # over that learner's mean error of the second half
    oracle_to_restart: tuple[float, float]  # the same two of the model of the whole log, in hindsight
    oracle_to_late: tuple[float, float]
    to_late_as_hard: tuple[float, float]  # the same, were the baseline's errors as large there
    all_to_restart: tuple[float, float]  # all windows
    inside: tuple[float, float, float]  # of the first ten windows, within the 50, 90 and 95 % ellipsoids


def errors(predictions: Predictions) -> Floats:
    """Return position [m] and heading [rad] errors, [N, 2]."""
    return np.column_stack((predictions.position_error, predictions.heading_error))


def pair(values: Floats) -> tuple[float, float]:
    """Return two numbers as floats."""
    return float(values[0]), float(values[1])


def hindsight(log: Log, input_name: str) -> Floats:
    """Return the errors of the model of the whole log, on that log."""
    model = calibrate(log, input=input_name).model
    options = EvaluationOptions((SHORT_HORIZON,), ("none", "model"), model=model)
    made = evaluate(log, input=input_name, options=options).predictions
    return errors(next(each for each in made if each.method == "model"))


class Warthog:
    """Window sets with one input: drives by name, and what a learner without a memory makes of them."""

    def __init__(self, folder: Path, input_name: str, *, labels: bool = True) -> None:
        """Read and learn all logs; their column `terrain` counts where `labels` are wanted."""
        names = sorted({name for pair in GROUNDS.values() for name in pair})
        logs = {name: slipwise.open_log(folder / "warthog_windows" / f"{name}.csv.gz") for name in names}
        if not labels:
            logs = {
                name: replace(log, runs=tuple(replace(run, extra={}) for run in log.runs))
                for name, log in logs.items()
            }
        self.drives: dict[str, Drive] = {name: prepare_run(log, input_name) for name, log in logs.items()}
        learned = {
            name: learn_log(drive, Settings(), (SHORT_HORIZON,)) for name, drive in self.drives.items()
        }
        self.restart = {name: errors(each.predictions[0]) for name, each in learned.items()}
        self.baseline = {name: errors(each.baseline[0]) for name, each in learned.items()}
        self.oracle = {name: hindsight(log, input_name) for name, log in logs.items()}

    def visits(self, order: Sequence[str], *, same: bool) -> list[Visit]:
        """Drive the grounds in an order, twice."""
        names = [GROUNDS[ground][0] for ground in order]
        names += [GROUNDS[ground][0 if same else 1] for ground in order]
        learned = learn_sequence([self.drives[name] for name in names], Settings(), (SHORT_HORIZON,))
        label = " ".join(order) + (", the same logs again" if same else ", other logs")
        return [
            self._visit(label, name, place >= len(order), log.surface, log.predictions[0])
            for place, (name, log) in enumerate(zip(names, learned.logs, strict=True))
        ]

    def _visit(self, order: str, name: str, second: bool, surface: str, made: Predictions) -> Visit:
        own, restart, baseline = errors(made), self.restart[name], self.baseline[name]
        half = len(restart) // 2
        first, late = own[:FIRST].mean(axis=0), restart[half:].mean(axis=0)
        harder = baseline[:FIRST].mean(axis=0) / baseline[half:].mean(axis=0)
        return Visit(
            order=order,
            log=name,
            second=second,
            surface=surface,
            first=pair(first),
            to_restart=pair(first / restart[:FIRST].mean(axis=0)),
            to_late=pair(first / late),
            oracle_to_restart=pair(self.oracle[name][:FIRST].mean(axis=0) / restart[:FIRST].mean(axis=0)),
            oracle_to_late=pair(self.oracle[name][:FIRST].mean(axis=0) / late),
            to_late_as_hard=pair(first / (late * harder)),
            all_to_restart=pair(own.mean(axis=0) / restart.mean(axis=0)),
            inside=coverage(made.inside[:FIRST]),
        )


def one_surface(log: Log, input_name: str, horizon: float) -> float:
    """Return the mean error of a log with a memory over that without, of position and heading together."""
    drive = prepare_run(log, input_name)
    alone = errors(learn_log(drive, Settings(), (horizon,)).predictions[0]).mean(axis=0)
    with_memory = errors(learn_sequence([drive], Settings(), (horizon,)).logs[0].predictions[0]).mean(axis=0)
    return float(np.sqrt(np.prod(with_memory / alone)))


def print_visits(visits: Sequence[Visit], title: str) -> None:
    """Print means and extremes of a group of visits."""
    print(f"\n{title}\n")
    print(
        "| log | visits | first ten [m, rad] | to restart, most | oracle | to late, most | oracle "
        "| as hard, most | all to restart |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for name in sorted({visit.log for visit in visits}):
        own = [visit for visit in visits if visit.log == name]

        def most(field: str, own: Sequence[Visit] = own) -> str:
            return " ".join(f"{value:.2f}" for value in np.max([getattr(v, field) for v in own], axis=0))

        mean = " ".join(f"{value:.3f}" for value in np.mean([v.first for v in own], axis=0))
        whole = " ".join(f"{value:.3f}" for value in np.mean([v.all_to_restart for v in own], axis=0))
        fields = ("to_restart", "oracle_to_restart", "to_late", "oracle_to_late", "to_late_as_hard")
        ratios = " | ".join(map(most, fields))
        print(f"| {name} | {len(own)} | {mean} | {ratios} | {whole} |")
    logs = np.log([(*v.to_restart, *v.to_late, *v.to_late_as_hard) for v in visits])
    print(f"geometric means: {' '.join(f'{value:.3f}' for value in np.exp(logs.mean(axis=0)))}")


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    parser.add_argument(
        "--quick", action="store_true", help="two orders, and a fifth of the simulated visits"
    )
    arguments = parser.parse_args()
    content: dict[str, Any] = {"real": {}, "alone": {}, "simulated": [], "labels": []}
    folder = data_folder()
    for input_name, labels in itertools.product(("wheel", "command"), (True, False)) if folder else ():
        robot = Warthog(folder or Path(), input_name, labels=labels)
        orders = list(itertools.permutations(GROUNDS))[: 2 if arguments.quick else None]
        visits = [v for same in (False, True) for order in orders for v in robot.visits(order, same=same)]
        first = [v for v in visits if not v.second and v.order.split()[0] not in v.log]
        labelling = "with labels" if labels else "without labels"
        print_visits(first, f"{input_name}, {labelling}: first visits, other surfaces being known")
        print_visits(
            [v for v in visits if v.second and "other" in v.order],
            f"{input_name}, {labelling}: second visits, other logs",
        )
        print_visits(
            [v for v in visits if v.second and "same" in v.order],
            f"{input_name}, {labelling}: second visits, same logs",
        )
        content["real"][f"{input_name}, {labelling}"] = [asdict(v) for v in visits]
    for data in data_sets(folder) if folder else []:
        if data.name in FEW:
            log = slipwise.open_log(data.path)
            for name in input_names(log):
                ratio = one_surface(log, name, data.horizon)
                print(f"one log alone, {data.name} from {name}s: {ratio:.4f} of the error without a memory")
                content["alone"][f"{data.name} {name}"] = ratio
    for noise in NOISES:
        result = simulated_visits(noise, 20 if arguments.quick else 100, 1.0, seed=0)
        oracle = oracle_right(noise, 20 if arguments.quick else 100, 1.0, seed=0)
        print(f"\nsimulated, {noise} slip: {result}; the oracle is right in {oracle:.0%}")
        content["simulated"].append(asdict(result) | {"oracle_right": oracle})
        for wrong in (0.0, 0.3):
            labelled = labelled_visits(noise, 20 if arguments.quick else 60, wrong, seed=3)
            print(f"labels, {noise} slip: {labelled}")
            content["labels"].append(asdict(labelled))
    if arguments.json:
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
