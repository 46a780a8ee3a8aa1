# SPDX-License-Identifier: Apache-2.0
"""Drives a slalom across three floors with one controller and six sources of its model: which drives better?

Every seed has a course of its own, with noise of its own. A drive starts on gravel; the floor becomes wet
grass, then concrete. Intervals are 95 % ones by a bootstrap over seeds.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipwise.files import write_text_whole
from slipwise.models import Model
from slipwise_sim.demo.closed_loop import EACH_FLOOR, VARIANTS, VENDOR, drive_all, floor_model
from slipwise_sim.demo.slalom_course import FLOORS
from slipwise_sim.demo.tracking_score import SETTLED, Tracking, tracking

Floats = NDArray[np.float64]
Scores = dict[str, Tracking]

DRAWS = 2000  # of the bootstrap
LEARNERS = tuple(name for name in VARIANTS if name.startswith("live"))


def scores_of(job: tuple[int, list[Model]]) -> tuple[int, Scores]:
    """Drive the course of a seed with every variant, and score the drives."""
    seed, models = job
    driven = drive_all(seed, models)
    return seed, {name: tracking(drive, driven[EACH_FLOOR]) for name, drive in driven.items()}


def measured(seeds: int, processes: int, keep: Callable[[dict[int, Scores]], None]) -> dict[int, Scores]:
    """Learn the floors' models, and drive all seeds; say how far it is, and keep what there is after each."""
    begin = time.monotonic()
    scores: dict[int, Scores] = {}
    with ProcessPoolExecutor(processes) as pool:
        models = list(pool.map(floor_model, FLOORS))
        print(f"learned {len(models)} floors beforehand, {time.monotonic() - begin:.0f} s", flush=True)
        jobs = [pool.submit(scores_of, (seed, models)) for seed in range(1, seeds + 1)]
        for job in as_completed(jobs):
            seed, scores[seed] = job.result()
            means = "  ".join(f"{scores[seed][name].mean:.3f}" for name in VARIANTS)
            now = time.monotonic() - begin
            print(f"{len(scores):3} of {seeds}, seed {seed:3}, {now:4.0f} s: {means}", flush=True)
            keep(scores)
    return dict(sorted(scores.items()))


def interval(values: Floats, statistic: Callable[[Floats], Floats]) -> tuple[float, float, float]:
    """Return a statistic of values [seeds, ...] with its 95 % interval; it takes [draws, seeds, ...]."""
    rng = np.random.Generator(np.random.PCG64(1))
    drawn = values[rng.integers(0, len(values), (DRAWS, len(values)))]
    low, high = np.quantile(statistic(drawn), (0.025, 0.975), method="nearest")
    return float(statistic(values[None])[0]), float(low), float(high)


def mean_of(values: Floats) -> Floats:
    """Mean over the seeds of values [draws, seeds]."""
    return np.asarray(values.mean(axis=1))


def median_of(values: Floats) -> Floats:
    """Median over the seeds of values [draws, seeds], some of which may be infinite."""
    return np.asarray(np.sort(values, axis=1)[:, (values.shape[1] - 1) // 2])


def ratio_of(values: Floats) -> Floats:
    """Ratio of the means over the seeds of values [draws, seeds, 2]."""
    means = values.mean(axis=1)
    return np.asarray(means[:, 0] / means[:, 1])


def against(
    scores: dict[int, Scores], other: str, error: Callable[[Tracking], float]
) -> dict[str, list[float]]:
    """Return each learner's mean error over that of another variant, with its interval."""
    return {
        name: list(interval(np.array([[error(s[name]), error(s[other])] for s in scores.values()]), ratio_of))
        for name in VARIANTS
        if name != other
    }


def settled_mean(score: Tracking) -> float:
    """Mean error from 10 s after each change on [m]."""
    return float(np.mean(score.settled[1:]))


def summary(scores: dict[int, Scores]) -> dict[str, object]:
    """Return every figure with its interval."""

    def each(
        value: Callable[[Tracking], float], statistic: Callable[[Floats], Floats]
    ) -> dict[str, list[float]]:
        return {
            name: list(interval(np.array([value(s[name]) for s in scores.values()]), statistic))
            for name in VARIANTS
        }

    changes = range(len(FLOORS) - 1)
    return {
        "mean": each(lambda s: s.mean, mean_of),
        "rms": each(lambda s: s.rms, mean_of),
        "worst": each(lambda s: s.worst, mean_of),
        "seconds": each(lambda s: s.seconds, mean_of),
        "arrived": {name: sum(s[name].arrived for s in scores.values()) for name in VARIANTS},
        "to_vendor": against(scores, VENDOR, lambda s: s.mean),
        "to_each_floor": against(scores, EACH_FLOOR, settled_mean),
        "to_each_floor_by_floor": [
            against(scores, EACH_FLOOR, lambda s, floor=floor: s.settled[floor])
            for floor in range(len(FLOORS))
        ],
        "recovery": [each(lambda s, change=change: s.recovery[change], median_of) for change in changes],
    }


def text_of(value: list[float], digits: int) -> str:
    """Return a figure with its interval."""
    shown = ["never" if math.isinf(v) else f"{v:.{digits}f}" for v in value]
    return f"{shown[0]} ({shown[1]} to {shown[2]})"


def tables(found: dict, seeds: int) -> str:
    """Return the figures as Markdown."""
    lines = [
        f"Over {seeds} courses; in brackets 95 % intervals. Cross-track errors in metres, means over time.",
        "",
        "| the controller's model | mean | rms | worst | time, s | arrived | mean, over the vendor's |",
        "|---|---|---|---|---|---|---|",
    ]
    for name in VARIANTS:
        ratio = text_of(found["to_vendor"][name], 2) if name != VENDOR else "1"
        cells = [text_of(found[key][name], 3) for key in ("mean", "rms", "worst")]
        cells += [text_of(found["seconds"][name], 1), f"{found['arrived'][name]} of {seeds}", ratio]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    names = [floor.name for floor in FLOORS[1:]]
    recoveries = " | ".join(f"recovery, {name}, s" for name in names)
    lines += [
        "",
        f"From {SETTLED:g} s after a change on: error over that of a model for each floor. Recovery: median",
        "seconds from a change until the mean of 5 s is within 1.1 of that model's.",
        "",
        f"| the controller's model | both | {' | '.join(names)} | {recoveries} |",
        f"|---|{'---|' * (1 + 2 * len(names))}",
    ]
    for name in VARIANTS:
        cells = [text_of(found["to_each_floor"][name], 2)] if name != EACH_FLOOR else ["1"]
        for place in range(1, len(FLOORS)):
            ratio = found["to_each_floor_by_floor"][place]
            cells.append(text_of(ratio[name], 2) if name != EACH_FLOOR else "1")
        cells += [text_of(recovery[name], 1) for recovery in found["recovery"]]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def finite(value: object) -> object:
    """Return what JSON can hold: null for a number that is infinite or none."""
    if isinstance(value, dict):
        return {str(key): finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="how many courses")
    parser.add_argument("--processes", type=int, default=2, help="drives at a time")
    parser.add_argument("--json", type=Path, help="write every drive's scores and the figures to this file")
    parser.add_argument("--markdown", type=Path, help="write the tables to this file too")
    arguments = parser.parse_args()

    def keep(scores: dict[int, Scores]) -> None:
        found = summary(scores)
        if arguments.markdown:
            write_text_whole(arguments.markdown, tables(found, len(scores)))
        if arguments.json:
            drives = {seed: {name: asdict(s) for name, s in each.items()} for seed, each in scores.items()}
            write_text_whole(
                arguments.json, json.dumps(finite({"figures": found, "drives": drives}), indent=1) + "\n"
            )

    scores = measured(arguments.seeds, arguments.processes, keep)
    print("\n" + tables(summary(scores), len(scores)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
