# SPDX-License-Identifier: Apache-2.0
"""How long a robot must drive until its model is as good as it gets, on every real log.

Each log is predicted causally by `auto`. The errors are smoothed by the mean over a tenth of the log's
windows, at least five; the final error is the mean over the last third of the windows. Converged is the
first moment after which the smoothed error stays, for the rest of the first two thirds, within 10 % above
the final one. Where slip differs along a log the error never settles; such a log is listed as not converged.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from data_sets import DataSet, data_folder, data_sets
from numpy.typing import NDArray

import slipwise
from slipwise.evaluation import EvaluationOptions

Floats = NDArray[np.float64]

PUBLISHED_SECONDS = 46.0  # DRIVE's calibration drive (Baril et al. 2023)
WITHIN = 1.10  # of the final error
FEWEST_WINDOWS = 15
METHOD = "auto"


@dataclass(frozen=True)
class Convergence:
    """How long one log took to converge [s of driving before the prediction]; None where it did not."""

    log: str
    input: str
    horizon: float  # s
    driven: float  # s, in the whole log
    windows: int
    final_position: float  # m
    final_heading: float  # rad
    position: float | None
    heading: float | None


def smoothed(errors: Floats) -> Floats:
    """Return the mean of each error and those before it, over a tenth of the windows or five, [N]."""
    width = max(5, len(errors) // 10)
    sums = np.concatenate(([0.0], np.cumsum(errors)))
    ends = np.arange(1, len(errors) + 1)
    begins = np.maximum(ends - width, 0)
    return np.asarray((sums[ends] - sums[begins]) / (ends - begins))


def converged_after(errors: Floats, driven: Floats) -> tuple[float | None, float]:
    """Return the seconds driven [N] when the errors [N] had converged, and the final error."""
    last = 2 * len(errors) // 3
    final = float(errors[last:].mean())
    outside = np.flatnonzero(smoothed(errors)[:last] > WITHIN * final)
    first = 0 if not len(outside) else int(outside[-1]) + 1
    return (float(driven[first]) if first < last else None), final


def measure(data: DataSet) -> list[Convergence]:
    """Measure one log with every input that it has."""
    log = slipwise.open_log(data.path)
    options = EvaluationOptions(horizons=(data.horizon,), methods=("none", METHOD))
    found = []
    for name in ("wheel", "command"):
        if all((run.wheels if name == "wheel" else run.commands) is None for run in log.runs):
            continue
        (predictions,) = (
            p
            for p in slipwise.evaluate(log, input_name=name, options=options).predictions
            if p.method == METHOD
        )
        if len(predictions) < FEWEST_WINDOWS:
            continue
        length = predictions.t_end - predictions.t_start
        driven = np.cumsum(length) - length
        position, final_position = converged_after(predictions.position_error, driven)
        heading, final_heading = converged_after(predictions.heading_error, driven)
        found.append(
            Convergence(
                log=data.name,
                input=name,
                horizon=data.horizon,
                driven=float(length.sum()),
                windows=len(predictions),
                final_position=final_position,
                final_heading=final_heading,
                position=position,
                heading=heading,
            )
        )
    return found


def print_table(rows: list[Convergence]) -> None:
    """Print one line per log and input."""
    print(f"{'log':37} {'input':8}{'driven':>8}{'final error':>19}{'converged after [s]':>24}")
    print(f"{'':37} {'':8}{'[s]':>8}{'[m]':>10}{'[rad]':>9}{'position':>14}{'heading':>10}")
    for row in rows:
        print(
            f"{row.log:37} {row.input:8}{row.driven:8.0f}{row.final_position:10.3f}{row.final_heading:9.3f}"
            f"{_seconds(row.position):>14}{_seconds(row.heading):>10}"
        )
    for name in ("wheel", "command"):
        for error in ("position", "heading"):
            times = [getattr(row, error) for row in rows if row.input == name]
            reached = [time for time in times if time is not None]
            within = sum(time <= PUBLISHED_SECONDS for time in reached)
            print(
                f"{name}, {error}: {len(reached)} of {len(times)} converge, {within} within "
                f"{PUBLISHED_SECONDS:g} s; median {np.median(reached) if reached else np.nan:.0f} s"
            )
    print(f"DRIVE's published calibration drive takes {PUBLISHED_SECONDS:g} s (Baril et al. 2023).")


def _seconds(time: float | None) -> str:
    return "not" if time is None else f"{time:.0f}"


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file too")
    arguments = parser.parse_args()
    folder = data_folder()
    if folder is None:
        print("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
        return 2
    with ProcessPoolExecutor() as pool:
        rows = [row for found in pool.map(measure, data_sets(folder)) for row in found]
    print_table(rows)
    if arguments.json:
        content = {"published_seconds": PUBLISHED_SECONDS, "logs": [asdict(row) for row in rows]}
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
