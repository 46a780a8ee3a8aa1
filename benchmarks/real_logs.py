# SPDX-License-Identifier: Apache-2.0
"""Scores every method on every real log below SLIPWISE_DATA: held-out errors relative to the plain model."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

from data_sets import DataSet, data_folder, data_sets
from log_score import LogScore, best_basis_mean, log_score, mean_score
from reference import Comparison, compare, read_reference

import slipwise

INPUTS = ("wheel", "command")


@dataclass(frozen=True)
class Target:
    """What is to be reached over all logs, relative to the plain model."""

    position: float
    heading: float
    worst: float  # position, on every log


TARGETS = {"wheel": Target(0.35, 0.15, 1.02), "command": Target(0.32, 0.38, 1.05)}


def score_log(data: DataSet) -> list[LogScore]:
    """Evaluate all methods on one log, with every input that the log has."""
    log = slipwise.open_log(data.path)
    options = slipwise.EvaluationOptions(
        horizons=(data.horizon,), vendor_track_multiplier=data.vendor_track_multiplier
    )
    has = {
        "wheel": any(run.wheels is not None for run in log.runs),
        "command": any(run.commands is not None for run in log.runs),
    }
    scores = []
    for name in (name for name in INPUTS if has[name]):
        start = time.perf_counter()
        evaluation = slipwise.evaluate(log, input_name=name, options=options)
        scores.append(log_score(data.name, evaluation, time.perf_counter() - start))
    return scores


def score_all(folder: Path, only: str) -> list[LogScore]:
    """Evaluate all logs whose name contains `only`."""
    chosen = [data for data in data_sets(folder) if only in data.name]
    with ProcessPoolExecutor() as pool:
        return [score for scores in pool.map(score_log, chosen) for score in scores]


def print_logs(scores: Sequence[LogScore]) -> None:
    """Print one line per log and method of interest."""
    print(f"{'':34}held  mean error of none     auto / none, 95 % interval                    best basis afterwards")
    print(
        f"{'log':34}out       m      rad   position           heading             position          heading"
        f"            NIS   in 50 90 95 %"
    )
    for s in scores:
        none, auto = s.methods["none"], s.methods["auto"]
        print(
            f"{s.log:34}{s.windows:4}{'' if s.counts else '!':1}{none.position:8.3f} {none.heading:8.3f}   "
            f"{interval(auto.position_ratio)}   {interval(auto.heading_ratio)}   "
            f"{best(s, 'position')} {best(s, 'heading')} {auto.nis:6.2f}  "
            + " ".join(f"{100 * share:3.0f}" for share in auto.coverage)
        )


def print_ratios(scores: Sequence[LogScore]) -> None:
    """Print every method's ratios on every log, position / heading."""
    methods = method_names(scores)
    print(f"{'log':34}" + "".join(f"{m[:13]:>14}" for m in methods))
    for s in scores:
        cells = [
            f"{s.methods[m].position_ratio[0]:6.2f} /{s.methods[m].heading_ratio[0]:5.2f}" if m in s.methods else "-"
            for m in methods
        ]
        print(f"{s.log:34}" + "".join(f"{cell:>14}" for cell in cells))


def print_means(scores: Sequence[LogScore], target: Target) -> None:
    """Print the score of every method and whether `auto` reaches the target."""
    print(f"{'method':16}logs  position  heading   worst position                          worst heading")
    for method in method_names(scores):
        mean = mean_score(scores, method)
        if mean is None:
            continue
        note = "" if scores[0].methods.get(method) is None or scores[0].methods[method].causal else "  (not causal)"
        print(
            f"{method:16}{mean.logs:4}  {mean.position:8.3f} {mean.heading:8.3f}   "
            f"{mean.worst_position:6.2f} {mean.worst_position_log:32} "
            f"{mean.worst_heading:6.2f} {mean.worst_heading_log}{note}"
        )
    position, heading = best_basis_mean(scores)
    print(f"{'best afterwards':16}      {position:8.3f} {heading:8.3f}   (the best fixed basis of each log)")
    auto = mean_score(scores, "auto")
    if auto is not None:
        print(
            f"target of auto: position {verdict(auto.position, target.position)}, "
            f"heading {verdict(auto.heading, target.heading)}, "
            f"worst log's position {verdict(auto.worst_position, target.worst)}"
        )


def print_comparison(comparisons: Sequence[Comparison], missing: Sequence[str]) -> None:
    """Print absolute errors beside the reference's best basis of each log, chosen afterwards."""
    print(f"{'':34}        windows    position [m]: auto, its best     heading [rad]: auto, its best")
    for c in comparisons:
        words = [word for word, bad in zip(("position", "heading"), c.worse, strict=True) if bad]
        verdict_words = f"worse: {', '.join(words)}" if words else ""
        print(
            f"{c.log:34}{c.input:8}{c.windows:4}{c.reference_windows:4}   "
            f"{c.auto[0]:8.3f} {c.reference_best[0]:8.3f} {c.best[0]:14}"
            f"{c.auto[1]:8.3f} {c.reference_best[1]:8.3f} {c.best[1]:14} {verdict_words}"
        )
    print("\nWindows differ (the plain model's error is not the same, ours / the reference's):")
    for c in (c for c in comparisons if not c.same_windows):
        print(
            f"  {c.log:32} {c.input:8} {c.windows:4} / {c.reference_windows:<4} windows, "
            f"{c.none[0]:.3f} / {c.reference_none[0]:.3f} m, {c.none[1]:.3f} / {c.reference_none[1]:.3f} rad; "
            f"relative to its own none, auto {ratio(c.auto[0], c.none[0])} against "
            f"{ratio(c.reference_best[0], c.reference_none[0])} in position"
        )
    if missing:
        print("The reference has no figures for: " + ", ".join(missing))


def method_names(scores: Sequence[LogScore]) -> list[str]:
    """Return all methods, in the order of the evaluation that has most of them."""
    return list(max((s.methods for s in scores), key=len, default={}))


def interval(value: tuple[float, float, float]) -> str:
    """Write a ratio with its interval."""
    return f"{value[0]:5.2f} [{value[1]:.2f}, {value[2]:.2f}]"


def best(score: LogScore, error: str) -> str:
    """Write the best fixed basis and its ratio."""
    name = score.best_basis(error)
    method = score.methods[name]
    value = method.position_ratio[0] if error == "position" else method.heading_ratio[0]
    return f"{value:5.2f} {name:13}"


def ratio(error: float, plain: float) -> str:
    """Write a ratio of errors."""
    return f"{error / plain:.2f}" if plain > 0.0 else "-"


def verdict(value: float, limit: float) -> str:
    """Write a figure beside its limit."""
    return f"{value:.3f} (limit {limit}: {'reached' if value <= limit else 'MISSED'})"


def print_all(scores: Sequence[LogScore], comparisons: tuple[list[Comparison], list[str]] | None) -> None:
    """Print all tables."""
    for name in INPUTS:
        group = [s for s in scores if s.input == name]
        if not group:
            continue
        print(f"\n{name} input\n{'-' * (len(name) + 6)}")
        print_logs(group)
        print("\nMean error relative to the plain model, position / heading:")
        print_ratios(group)
        print("\nGeometric means over logs:")
        print_means(group, TARGETS[name])
        few = [f"{s.log} ({s.windows})" for s in group if not s.counts]
        if few:
            print("Left out of the means for too few held-out windows (marked !): " + ", ".join(few))
    if comparisons is not None:
        print("\nbeside the reference\n--------------------")
        print_comparison(*comparisons)


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    arguments = parser.parse_args()
    folder = data_folder()
    if folder is None:
        print("SLIPWISE_DATA is not set: it names the folder that holds the real logs")
        return 2
    start = time.perf_counter()
    scores = score_all(folder, arguments.only)
    reference = folder / "reference.csv"
    comparisons = compare(scores, read_reference(reference)) if reference.exists() else None
    print_all(scores, comparisons)
    print(f"\n{len(scores)} evaluations in {time.perf_counter() - start:.1f} s")
    if arguments.json:
        content = {
            "scores": [asdict(s) for s in scores],
            "means": {
                f"{name}/{method}": asdict(mean)
                for name in INPUTS
                for group in [[s for s in scores if s.input == name]]
                for method in method_names(group)
                if (mean := mean_score(group, method)) is not None
            },
            "reference": [asdict(c) for c in comparisons[0]] if comparisons else [],
        }
        arguments.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
