# SPDX-License-Identifier: Apache-2.0
"""Every mechanism of the learner on and off over the real logs, from commands and from wheels.

Held-out position and heading errors at the longest horizon are over those of the kinematic baseline,
geometric means over logs; beside them stand the change against the default, the fractions inside the
50/90/95 % ellipsoids, processor time over the default's, and the lines of source that the mechanism costs.
Two more tables hold mechanisms
against the strongest simple alternative that a user would take in their place, on real logs and in
simulations.

    python benchmarks/ablation.py --only warthog/ --json ablation.json
    python benchmarks/ablation.py --alternatives
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from alternatives_of_motion import motion_rows
from alternatives_of_poses import pose_rows
from alternatives_of_verdicts import verdict_rows
from data_sets import FEW, data_sets, required_folder
from mechanisms import CALIBRATION, LIMITS, MECHANISMS, Mechanism
from replay_score import MeanReplay, ReplayScore, mean_replay
from tuning_constants import build_tuned_core
from variants import of_input, scored_variants

from slipwise.cli.output import Column, Output

COLUMNS = (
    Column("without"),
    Column("position", True),
    Column("change %", True),
    Column("heading", True),
    Column("change %", True),
    Column("50/90/95 %", True),
    Column("CPU", True),
    Column("lines", True),
)
INPUTS = ("command", "wheel")
GAIN, LINES = 2.0, 200  # what gains less, in %, and costs more has to show elsewhere what it is for
FOOTNOTE = (
    "Lines are those of a mechanism's own files and, in shared ones, those that name it; rows overlap. "
    f"*: gains under {GAIN:g} % of either error, from either input, at more than {LINES} lines. "
    "What no setting switches off - refits, correlated scores - is switched off by its constants, in a build "
    "of its own. Correlated scores are for the covariance of parameters (promises/covariance.py), branches "
    "for new terrain (following.py). Gating of poses cannot be switched off."
)


Found = Sequence[tuple[Mechanism, list[ReplayScore] | None]]


def rows_of(found: Found, default: Sequence[ReplayScore], name: str) -> list[tuple[str, ...]]:
    """Return one row per mechanism, for one input."""
    before = mean_replay(of_input(default, name))
    if before is None:
        return []
    rows = [("(nothing)", *_figures(before, before), "")]
    for mechanism, scores in found:
        mean = mean_replay(of_input(scores or [], name))
        if mean is not None:
            lines = mechanism.lines
            mark = "*" if lines > LINES and largest_gain(scores or [], default) < GAIN else ""
            rows.append((mechanism.variant.name, *_figures(mean, before), f"{lines}{mark}" if lines else "-"))
    uncalibrated = replace(before, inside=before.inside_normal)
    rows.append(("Student-t calibration", *_figures(uncalibrated, before), str(CALIBRATION.lines)))
    return rows


def largest_gain(scores: Sequence[ReplayScore], default: Sequence[ReplayScore]) -> float:
    """Return by how much an error grows at most without a mechanism, from either input [%]."""
    gains = [0.0]
    for name in INPUTS:
        mean, before = mean_replay(of_input(scores, name)), mean_replay(of_input(default, name))
        if mean is not None and before is not None:
            gains += [_gain(mean.position, before.position), _gain(mean.heading, before.heading)]
    return max(gains)


def _gain(without: float, default: float) -> float:
    return 100.0 * (without / default - 1.0)


def _figures(mean: MeanReplay, default: MeanReplay) -> tuple[str, ...]:
    same = mean is default
    return (
        f"{mean.position:.4f}",
        "" if same else f"{_gain(mean.position, default.position):+.1f}",
        f"{mean.heading:.4f}",
        "" if same else f"{_gain(mean.heading, default.heading):+.1f}",
        "/".join(f"{100.0 * fraction:.1f}" for fraction in mean.inside),
        f"{mean.seconds / default.seconds:.2f}",
    )


def limits_line(scores: Sequence[ReplayScore]) -> str:
    """Say what looking for limits of the actuator costs and finds: it changes no prediction of the filter."""
    mean = mean_replay(of_input(scores, "command"))
    if mean is None:
        return "No log has commands: limits were not looked for."
    fraction = mean.limits_seconds / mean.seconds
    return (
        "Limits of the actuator are looked for after learning and change none of these predictions: "
        f"{fraction:.2f} times the default's processor time, kept on {mean.limits_kept} of {mean.logs} logs "
        f"with commands, {LIMITS.lines} lines."
    )


def main() -> int:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, help="write all figures to this file too")
    parser.add_argument("--only", default="", help="only logs whose name contains this")
    parser.add_argument("--few", action="store_true", help="only a few short logs of most data sets")
    parser.add_argument("--mechanism", default="", help="only mechanisms whose name contains this")
    parser.add_argument("--workers", type=int, default=2, help="processes at a time")
    parser.add_argument("--alternatives", action="store_true", help="only the tables of alternatives")
    arguments = parser.parse_args()
    if arguments.alternatives:
        show_alternatives(Output(arguments.json))
        return 0
    folder = required_folder()
    logs = [
        d.name for d in data_sets(folder) if arguments.only in d.name and (not arguments.few or d.name in FEW)
    ]
    chosen = [m for m in MECHANISMS if arguments.mechanism in m.variant.name]
    core = build_tuned_core() if any(m.variant.constants for m in chosen) else None
    output, found = Output(arguments.json), []
    mechanisms = [LIMITS, *chosen]
    variants = [mechanism.variant for mechanism in mechanisms]
    scored = scored_variants(variants, logs, core=core, workers=arguments.workers)
    for mechanism, scores in zip(mechanisms, scored, strict=True):
        found.append((mechanism, scores))
        output.document(as_document(found))
    (_, default), *others = found
    if not default:
        print("no log of that name has enough held-out segments")
        return 2
    for name in INPUTS:
        count = len(of_input(default, name))
        if count:
            output.table(f"From {name}s, {count} logs", COLUMNS, rows_of(others, default, name))
    output.line(limits_line(default))
    output.line(FOOTNOTE)
    if not (arguments.only or arguments.few or arguments.mechanism):
        show_alternatives(output)
    return 0


BESIDE = (
    Column("mechanism"),
    Column("alternative"),
    Column("where"),
    Column("position", True),
    Column("heading", True),
    Column("logs", True),
)
VERDICTS = (Column("logs"), Column("of", True), Column("good, with", True), Column("good, without", True))


def show_alternatives(output: Output) -> None:
    """Show mechanisms beside their alternatives."""
    rows = []
    for row in (*motion_rows(), *pose_rows()):
        errors = tuple(f"{mean:.2f}" if math.isfinite(mean) else "-" for mean in row.mean)
        rows.append((row.mechanism, row.alternative, row.where, *errors, str(len(row.ratios))))
    output.table("Errors over those of the alternative", BESIDE, rows)
    verdicts = [(v.where, str(v.logs), str(v.with_it), str(v.without)) for v in verdict_rows()]
    output.table("Models called good, with and without evidence of contradictions", VERDICTS, verdicts)


def as_document(found: Found) -> dict[str, dict[str, object]]:
    """Return all means and figures of logs, for JSON."""
    return {
        mechanism.variant.name: {
            "lines": mechanism.lines,
            "means": {
                name: mean.as_dict() if (mean := mean_replay(of_input(scores or [], name))) else None
                for name in INPUTS
            },
            "logs": [vars(score) for score in scores or []],
        }
        for mechanism, scores in found
    }


if __name__ == "__main__":
    sys.exit(main())
