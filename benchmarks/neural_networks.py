# SPDX-License-Identifier: Apache-2.0
"""Scores `auto` beside neural networks on the same windows of every real log below SLIPWISE_DATA, by log."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

from data_sets import DataSet, data_sets, input_names, required_folder
from log_score import LogScore, geometric_mean, log_score
from neural import add_networks

import slipwise

NETWORKS = ("neural", "neural-residual")
METHODS = ("none", "auto", *NETWORKS)
ERRORS = ("position", "heading")
ALLOWED = 1.02  # times the better network's error, on one log


def score_log(data: DataSet) -> list[LogScore]:
    """Evaluate `auto` and the networks on one log, with every input that the log has."""
    add_networks()
    log = slipwise.open_log(data.path)
    options = slipwise.EvaluationOptions(horizons=(data.horizon,), methods=METHODS)
    scores = []
    for name in input_names(log):
        start = time.perf_counter()
        evaluation = slipwise.evaluate(log, input=name, options=options)
        scores.append(log_score(data.name, evaluation, time.perf_counter() - start))
    return scores


def to_network(score: LogScore, network: str, error: str) -> float:
    """Return the mean error of `auto` over that of a network."""
    return float(getattr(score.methods["auto"], error) / getattr(score.methods[network], error))


def to_best(score: LogScore, error: str) -> float:
    """Return the mean error of `auto` over that of the network that is better on this log."""
    return max(to_network(score, network, error) for network in NETWORKS)


def lost(scores: Sequence[LogScore], allowed: float = ALLOWED) -> list[tuple[str, str, str, float]]:
    """Return where `auto` is worse than allowed beside the better network: log, input, error, ratio."""
    return [
        (score.log, score.input, error, to_best(score, error))
        for score in scores
        if score.counts
        for error in ERRORS
        if to_best(score, error) > allowed
    ]


def print_table(scores: Sequence[LogScore]) -> None:
    """Print a row of Markdown for each log, and the geometric means."""
    print("| log | windows | none | auto / none | neural / none | neural-residual / none | auto / best |")
    print("|---|---|---|---|---|---|---|")
    for s in scores:
        none = s.methods["none"]
        cells = [_pair(s.methods[m].position_ratio[0], s.methods[m].heading_ratio[0]) for m in METHODS[1:]]
        best = _pair(to_best(s, "position"), to_best(s, "heading"))
        mark = "" if s.counts else " (too few)"
        error = f"{none.position:.3f} m, {none.heading:.3f} rad"
        print(f"| {s.log} | {s.windows}{mark} | {error} | {' | '.join(cells)} | {best} |")
    counted = [s for s in scores if s.counts]
    cells = [_mean(counted, method) for method in METHODS[1:]]
    best = _pair(*(geometric_mean([to_best(s, error) for s in counted]) for error in ERRORS))
    print(f"| **geometric mean of {len(counted)}** | | | {' | '.join(cells)} | {best} |")


def _mean(scores: Sequence[LogScore], method: str) -> str:
    position = geometric_mean([s.methods[method].position_ratio[0] for s in scores])
    return _pair(position, geometric_mean([s.methods[method].heading_ratio[0] for s in scores]))


def _pair(position: float, heading: float) -> str:
    return f"{position:.3f} / {heading:.3f}"


def main() -> int:
    """Run the benchmark; the exit code is 1 where `auto` loses on a log."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    parser.add_argument("--workers", type=int, default=None, help="processes; default: one a core")
    arguments = parser.parse_args()
    chosen = [data for data in data_sets(required_folder()) if arguments.only in data.name]
    with ProcessPoolExecutor(arguments.workers) as pool:
        scores = [score for found in pool.map(score_log, chosen) for score in found]
    for name in ("wheel", "command"):
        print(f"\n== {name} input, position / heading ==\n")
        print_table([s for s in scores if s.input == name])
    losses = lost(scores)
    print(f"\nWorse than {ALLOWED:g} of the better network on {len(losses)} of {2 * len(scores)}:")
    for log, name, error, ratio in losses:
        print(f"- {log} ({name}), {error}: {ratio:.3f}")
    if arguments.json:
        text = json.dumps([asdict(score) for score in scores], indent=1) + "\n"
        arguments.json.write_text(text, encoding="utf-8")
    return int(bool(losses))


if __name__ == "__main__":
    sys.exit(main())
