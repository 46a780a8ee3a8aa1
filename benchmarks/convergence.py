# SPDX-License-Identifier: Apache-2.0
"""How long a robot must drive until its model is as good as it gets, on every real log.

Each log is predicted causally by `auto`, and by the model that `auto` has learned at its end: the same
windows, so that what differs is what was known, not how hard the driving was. Converged is the first window
from which on the mean error is within 10 % of the final model's, both over the next ten windows (this is the
smoothing: 50 s of driving at 5 s) and over all the rest. The final model has seen those windows, which makes
the bound strict; where slip differs along a log, it is never met, and the log is listed as not converged.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from data_sets import DataSet, data_sets, input_names, required_folder
from numpy.typing import NDArray

import slipwise
from slipwise.evaluation import EvaluationOptions

Floats = NDArray[np.float64]

PUBLISHED_SECONDS = 46.0  # DRIVE's calibration drive (Baril et al. 2023)
WITHIN = 1.10  # of the final error
FEWEST_WINDOWS = 15
SMOOTHING = 10  # windows


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


def converged_after(errors: Floats, final: Floats, driven: Floats) -> float | None:
    """Return the seconds driven [N] from which on `errors` [N] are near those of the final model [N]."""
    for k in range(len(errors) - SMOOTHING + 1):
        soon, rest = slice(k, k + SMOOTHING), slice(k, None)
        if all(errors[part].sum() <= WITHIN * final[part].sum() for part in (soon, rest)):
            return float(driven[k])
    return None


def measure(data: DataSet) -> list[Convergence]:
    """Measure one log with every input that it has."""
    log = slipwise.open_log(data.path)
    found = []
    for name in input_names(log):
        options = EvaluationOptions(
            horizons=(data.horizon,),
            methods=("none", "auto", "model"),
            model=slipwise.calibrate(log, input=name).model,
        )
        evaluation = slipwise.evaluate(log, input=name, options=options)
        by_method = {p.method: p for p in evaluation.predictions}
        auto, final = by_method["auto"], by_method["model"]
        if len(auto) < FEWEST_WINDOWS:
            continue
        length = auto.t_end - auto.t_start
        driven = np.cumsum(length) - length
        found.append(
            Convergence(
                log=data.name,
                input=name,
                horizon=data.horizon,
                driven=float(length.sum()),
                windows=len(auto),
                final_position=float(final.position_error.mean()),
                final_heading=float(final.heading_error.mean()),
                position=converged_after(auto.position_error, final.position_error, driven),
                heading=converged_after(auto.heading_error, final.heading_error, driven),
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
    folder = required_folder()
    with ProcessPoolExecutor() as pool:
        rows = [row for found in pool.map(measure, data_sets(folder)) for row in found]
    print_table(rows)
    if arguments.json:
        content = {"published_seconds": PUBLISHED_SECONDS, "logs": [asdict(row) for row in rows]}
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
