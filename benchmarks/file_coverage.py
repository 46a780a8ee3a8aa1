# SPDX-License-Identifier: Apache-2.0
"""Whether what a model file states is true: learned from half of each real log, held against the other."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from data_sets import data_folder, data_sets
from numpy.typing import NDArray

from slipwise.calibration import Settings, calibrate
from slipwise.calibration.plain import model_predictor
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.predictors import predictions_of
from slipwise.calibration.prepared_run import collect_windows, prepare_run
from slipwise.errors import SlipwiseError
from slipwise.logs import Inputs, Log, Poses, Run, open_log
from slipwise.models import Model

Floats = NDArray[np.float64]

HORIZONS = (1.0, 2.0, 5.0)  # s
FRACTIONS = (0.5, 0.9, 0.95)
FEWEST = 10  # windows of the second half
BEFORE = 10.0  # s of inputs before the second half; no drive remembers more


@dataclass(frozen=True)
class Coverage:
    """How a file's ellipsoids hold the second half of a log at one horizon."""

    horizon: float  # s
    windows: int
    inside: tuple[float, ...]  # fraction within each of FRACTIONS


def halves(log: Log) -> tuple[Log, Log]:
    """Cut a log in two by time of recording; a run that holds the middle is cut there."""
    lengths = np.array([run.poses.t[-1] - run.poses.t[0] for run in log.runs])
    ends = np.cumsum(lengths)
    middle = int(np.searchsorted(ends, ends[-1] / 2.0))
    at = float(log.runs[middle].poses.t[-1] - (ends[middle] - ends[-1] / 2.0))
    first, second = _before(log.runs[middle], at), _after(log.runs[middle], at)
    return (
        replace(log, runs=(*log.runs[:middle], first)),
        replace(log, runs=(second, *log.runs[middle + 1 :])),
    )


def _before(run: Run, t: float) -> Run:
    commands, wheels = (_inputs(part, -np.inf, t) for part in (run.commands, run.wheels))
    return replace(run, commands=commands, wheels=wheels, poses=_cut(run.poses, -np.inf, t), extra={})


def _after(run: Run, t: float) -> Run:
    commands, wheels = (_inputs(part, t - BEFORE, np.inf) for part in (run.commands, run.wheels))
    return replace(run, commands=commands, wheels=wheels, poses=_cut(run.poses, t, np.inf), extra={})


PartT = TypeVar("PartT", Poses, Inputs)


def _inputs(part: Inputs | None, begin: float, end: float) -> Inputs | None:
    return None if part is None else _cut(part, begin, end)


def _cut(part: PartT, begin: float, end: float) -> PartT:
    kept = (part.t >= begin) & (part.t < end)
    return replace(
        part, **{name: value[kept] for name, value in vars(part).items() if isinstance(value, np.ndarray)}
    )


def coverage(model: Model, log: Log) -> list[Coverage]:
    """Return how the second half lies in the ellipsoids that the file states, tails of the file included."""
    drive = prepare_run(log, model.content.input)
    predictor = model_predictor(model)
    sets = [collect_windows(drive, horizon, Settings().rules()) for horizon in HORIZONS]
    judged = [predictions_of(predictor, targets, targets) for targets in sets if len(targets) >= FEWEST]
    return [_coverage(predictions) for predictions in judged]


def _coverage(predictions: Predictions) -> Coverage:
    fractions = tuple(float(np.mean(predictions.inside <= fraction)) for fraction in FRACTIONS)
    return Coverage(predictions.horizon, len(predictions), fractions)


def _row(name: str, fractions: Floats) -> str:
    return f"{name:52}" + "".join(f"{100 * fraction:7.1f}" for fraction in fractions)


def main() -> None:
    """Print the fractions inside the 50, 90 and 95 % ellipsoids, per log and their means."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--filter", default="", help="only logs whose name contains this")
    wanted = parser.parse_args().filter
    folder = data_folder()
    if folder is None:
        raise SystemExit("SLIPWISE_DATA must name the folder of the real logs")
    found: dict[tuple[str, float], list[tuple[float, ...]]] = {}
    for data_set in data_sets(folder):
        if wanted not in data_set.name:
            continue
        log = open_log(data_set.path)
        for name in ("wheel", "command"):
            try:
                first, second = halves(log)
                rows = coverage(calibrate(first, input=name).model, second)
            except SlipwiseError as problem:
                print(f"{data_set.name}, {name}: {problem.what}")
                continue
            for row in rows:
                found.setdefault((name, row.horizon), []).append(row.inside)
                title = f"{data_set.name}, {name}, {row.horizon:g} s, {row.windows} windows"
                print(_row(title, np.array(row.inside)), flush=True)
    print()
    for (name, horizon), fractions in sorted(found.items()):
        print(_row(f"mean over {len(fractions)} logs, {name}, {horizon:g} s", np.mean(fractions, axis=0)))


if __name__ == "__main__":
    main()
