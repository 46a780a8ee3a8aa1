# SPDX-License-Identifier: Apache-2.0
"""Scores every method on every real log below SLIPWISE_DATA: held-out errors over the baseline's."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

from data_sets import DataSet, data_sets, required_folder
from log_score import LogScore, log_score, mean_score
from real_log_tables import (
    Target,
    method_names,
    print_comparison,
    print_few,
    print_logs,
    print_means,
    print_ratios,
    print_window_differences,
)
from reference import Comparison, compare, read_reference
from uncertainty import print_chances, print_coverage

import slipwise

TARGETS = {"wheel": Target(0.31, 0.135, 1.0), "command": Target(0.25, 0.27, 1.0)}


def score_log(data: DataSet) -> list[LogScore]:
    """Evaluate all methods on one log, with every input that the log has."""
    log = slipwise.open_log(data.path)
    options = slipwise.EvaluationOptions(
        horizons=(data.horizon,), vendor_wheel_separation_multiplier=data.vendor_wheel_separation_multiplier
    )
    has = {
        "wheel": any(run.wheels is not None for run in log.runs),
        "command": any(run.commands is not None for run in log.runs),
    }
    scores = []
    for name in (name for name in TARGETS if has[name]):
        start = time.perf_counter()
        evaluation = slipwise.evaluate(log, input=name, options=options)
        scores.append(log_score(data.name, evaluation, time.perf_counter() - start))
    return scores


def score_all(folder: Path, only: str) -> list[LogScore]:
    """Evaluate all logs whose name contains `only`."""
    chosen = [data for data in data_sets(folder) if only in data.name]
    with ProcessPoolExecutor() as pool:
        return [score for scores in pool.map(score_log, chosen) for score in scores]


def print_all(scores: Sequence[LogScore], comparisons: tuple[list[Comparison], list[str]] | None) -> None:
    """Print all tables."""
    for name, target in TARGETS.items():
        group = [s for s in scores if s.input == name]
        if not group:
            continue
        print(f"\n== {name} input ==\n")
        print_logs(group)
        print("\nMean error relative to the kinematic baseline, position / heading:\n")
        print_ratios(group)
        print("\nGeometric means over logs of the errors relative to the kinematic baseline:\n")
        print_means(group, target)
        print_few(group)
    for name in (*TARGETS, "both"):
        group = [s for s in scores if name in (s.input, "both")]
        if group:
            inputs = f"{name} input" if name in TARGETS else "both inputs"
            print(f"\n== is the uncertainty true? {inputs}, all held-out windows of all logs ==\n")
            print_coverage(group, method_names(group))
            print_chances(group)
    if comparisons is not None:
        print(
            "\n== beside the reference: mean errors, and its best basis of each log, chosen afterwards ==\n"
        )
        print_comparison(*comparisons)
        print("\nWhere the windows are not the same, absolute errors cannot be compared:\n")
        print_window_differences(comparisons[0])


def as_json(scores: Sequence[LogScore], comparisons: Sequence[Comparison]) -> str:
    """Return all figures as JSON."""
    groups = {name: [s for s in scores if s.input == name] for name in TARGETS}
    means = {
        name: {method: mean_score(group, method) for method in method_names(group)}
        for name, group in groups.items()
    }
    content = {
        "scores": [asdict(score) for score in scores],
        "means": {
            name: {m: asdict(mean) for m, mean in table.items() if mean} for name, table in means.items()
        },
        "reference": [asdict(c) for c in comparisons],
    }
    return json.dumps(content, indent=1) + "\n"


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    arguments = parser.parse_args()
    folder = required_folder()
    start = time.perf_counter()
    scores = score_all(folder, arguments.only)
    reference = folder / "reference.csv"
    comparisons = compare(scores, read_reference(reference)) if reference.exists() else None
    print_all(scores, comparisons)
    print(f"\n{len(scores)} evaluations in {time.perf_counter() - start:.1f} s")
    if arguments.json:
        text = as_json(scores, comparisons[0] if comparisons else [])
        arguments.json.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
