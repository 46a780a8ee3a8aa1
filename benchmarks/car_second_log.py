# SPDX-License-Identifier: Apache-2.0
"""A car's second log: predicted by one learner that goes on from a first, and from nothing.

The logs are those of `car_commands.py`. Every window is predicted causally. Between two of the logs the
car has another floor, other commands or another battery: what was learned of it need not hold.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import tempfile
from pathlib import Path

from car_commands import ALL, LOGS, best_gains, bicycle_poses, errors, read

import slipwise as sw
from slipwise.calibration.learned_log import learn_log
from slipwise.calibration.predictions import Predictions
from slipwise.calibration.prepared_run import prepare_run


def predicted(log: sw.Log, horizon: float) -> Predictions:
    """Predict the windows of all runs of a log, in their order, by one learner."""
    (made,) = learn_log(prepare_run(log, "command"), sw.Settings(), (horizon,)).predictions
    return made


def after(first: sw.Log, second: sw.Log, horizon: float) -> tuple[float, float]:
    """Return the errors on the second log of a learner that goes on from the first."""
    both = dataclasses.replace(second, runs=(*first.runs, *second.runs))
    made = predicted(both, horizon)
    own = made.run >= len(first.runs)
    return errors(made.measured[own], made.pose[own])


def rows(folder: Path, horizon: float, names: tuple[str, ...]) -> list[dict[str, object]]:
    """Return a row for each log alone, and for each after each other."""
    table: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as work:
        logs = {name: read(folder / f"{name}.csv.gz", Path(work)) for name in names}
    for second, log in logs.items():
        made = predicted(log, horizon)
        alone = errors(made.measured, made.pose)
        gains = errors(made.measured, bicycle_poses(log, made, ALL, best_gains(log, made, ALL)))
        table.append({"log": second, "windows": len(made), "alone": alone, "bicycle": gains})
        print(json.dumps(table[-1]), flush=True)
        for first in names:
            if first != second:
                on = after(logs[first], log, horizon)
                ratio = [mine / fresh for mine, fresh in zip(on, alone, strict=True)]
                table.append({"log": second, "first": first, "goes_on": on, "over_alone": ratio})
                print(json.dumps(table[-1]), flush=True)
    return table


def main() -> None:
    """Print a row of JSON for each log alone and for each ordered pair."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="with the logs of DART")
    parser.add_argument("--horizon", type=float, default=1.0, help="s")
    parser.add_argument("--logs", nargs="+", default=list(LOGS))
    given = parser.parse_args()
    rows(given.folder, given.horizon, tuple(given.logs))


if __name__ == "__main__":
    main()
